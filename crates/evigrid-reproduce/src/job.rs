//! One item at work, and what all groups have in common.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use evigrid_core::name_hint;
use evigrid_replay::DatasetInfo;
use evigrid_results::MethodResult;

use crate::chart::{Key, Sheet};
use crate::journey::Journey;
use crate::table::csv_text;
use crate::{Folders, Tools, write_file};

/// The function that makes an item.
pub type Make = fn(&mut Job<'_, '_>) -> Result<()>;

/// Makes one item of a group or all of them; of all, those whose data are not there are left out and named.
pub fn make_items(
    group: &'static str,
    items: &[(&'static str, Make)],
    item: Option<&str>,
    folders: &Folders,
    tools: &mut Tools<'_>,
) -> Result<Vec<PathBuf>> {
    let mut job = Job::new(group, folders, tools);
    if let Some(item) = item {
        let Some((name, make)) = items.iter().find(|(name, _)| *name == item) else {
            let hint = name_hint(item, items.iter().map(|(name, _)| *name));
            bail!("reproduce: unknown item `{group}/{item}`{hint}");
        };
        job.begin(name);
        make(&mut job)?;
        return Ok(job.files);
    }
    for (name, make) in items {
        job.begin(name);
        match make(&mut job) {
            Err(error) if error.is::<Missing>() => log::warn!("{name} is left out: {error}"),
            result => result?,
        }
    }
    Ok(job.files)
}

/// Data that an item needs and that are not there.
#[derive(Debug)]
pub struct Missing(String);

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Missing {}

/// One item at work: where it reads and writes, and what it has written.
pub struct Job<'a, 'b> {
    pub folders: &'a Folders,
    pub tools: &'a mut Tools<'b>,
    pub files: Vec<PathBuf>,
    /// Results of maps that several items are made from, by a name of the group's own.
    pub results: BTreeMap<String, Vec<MethodResult>>,
    /// Maps that were followed frame by frame, likewise.
    pub journeys: BTreeMap<String, Vec<Journey>>,
    group: &'static str,
    item: &'static str,
}

impl<'a, 'b> Job<'a, 'b> {
    pub fn new(group: &'static str, folders: &'a Folders, tools: &'a mut Tools<'b>) -> Self {
        let (files, results, journeys) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
        Self { folders, tools, files, results, journeys, group, item: "" }
    }

    /// The next item.
    pub fn begin(&mut self, item: &'static str) {
        self.item = item;
        self.say("");
    }

    /// Tells what is being done.
    pub fn say(&mut self, what: &str) {
        let text = if what.is_empty() { self.item.to_owned() } else { format!("{}: {what}", self.item) };
        (self.tools.report)(&text);
    }

    /// Name of the item.
    pub fn item(&self) -> &'static str {
        self.item
    }

    /// The group's folder.
    pub fn dir(&self) -> PathBuf {
        self.folders.out.join(self.group)
    }

    /// Writes the item's table.
    pub fn write_table<R>(&mut self, header: &[&str], rows: impl IntoIterator<Item = R>) -> Result<()>
    where
        R: IntoIterator<Item = String>,
    {
        let text = csv_text(header, rows)?;
        self.write(&format!("{}.csv", self.item), &text)
    }

    /// Writes one more table of the item, ITEM.NAME.csv.
    pub fn write_more<R>(
        &mut self,
        name: &str,
        header: &[&str],
        rows: impl IntoIterator<Item = R>,
    ) -> Result<()>
    where
        R: IntoIterator<Item = String>,
    {
        let text = csv_text(header, rows)?;
        self.write(&format!("{}.{name}.csv", self.item), &text)
    }

    /// Writes the item's picture.
    pub fn write_picture(&mut self, sheet: &Sheet) -> Result<()> {
        let text = sheet.draw()?;
        self.write(&format!("{}.svg", self.item), &text)
    }

    /// Writes the item's picture with a key of its colours.
    pub fn write_keyed_picture(&mut self, sheet: &Sheet, key: &[Key]) -> Result<()> {
        let text = sheet.draw_with_key(key)?;
        self.write(&format!("{}.svg", self.item), &text)
    }

    fn write(&mut self, name: &str, text: &str) -> Result<()> {
        let path = self.dir().join(name);
        write_file(&path, text.as_bytes())?;
        self.files.push(path);
        Ok(())
    }

    /// The folder of a data set that the project knows, if it is there.
    pub fn dataset(&self, id: &str) -> Result<Option<(DatasetInfo, PathBuf)>> {
        let known = evigrid_replay::find_dataset(id)?;
        let known = known.with_context(|| format!("no data set {id} in datasets/"))?;
        let dir = known.dir_below(&self.folders.data);
        Ok(dir.exists().then_some((known, dir)))
    }

    /// The error of an item whose data set is not there.
    pub fn missing(&self, id: &str) -> anyhow::Error {
        let (Self { group, item, .. }, data) = (self, self.folders.data.display());
        Missing(format!(
            "{group}/{item} needs the data set {id}, found none below {data} \
             (scripts/download_datasets.sh {id} {data} fetches it)"
        ))
        .into()
    }
}
