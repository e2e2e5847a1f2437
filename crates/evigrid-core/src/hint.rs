/// Hint to put after an unknown name: ` (did you mean ...?)` with the most similar known one, or all known
/// names where none is similar.
pub fn name_hint<S: AsRef<str>>(name: &str, known: impl IntoIterator<Item = S>) -> String {
    let known: Vec<S> = known.into_iter().collect();
    let similarity = |other: &S| strsim::normalized_damerau_levenshtein(other.as_ref(), name);
    match known.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b))) {
        Some(best) if similarity(best) >= 0.6 => format!(" (did you mean `{}`?)", best.as_ref()),
        _ => {
            let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
            format!(" (there are {})", known.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typo_gets_the_nearest_name_and_nonsense_all_of_them() {
        assert_eq!(name_hint("stret", ["bars", "street"]), " (did you mean `street`?)");
        assert_eq!(name_hint("xyz", ["bars", "street"]), " (there are bars, street)");
    }
}
