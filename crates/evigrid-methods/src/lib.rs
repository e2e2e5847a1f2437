//! The mapping methods by name: what each is, needs and shows, its settings, and how an empty map of it is
//! made.
//!
//! Programs that run methods (the evaluation, a language binding) need this crate alone: neither recordings
//! nor truth nor scores come with it. A method of one's own joins the built-in ones by [`Methods::with`].

mod entry;
mod list;
mod methods;
mod settings;

pub use entry::{Entry, Family, MethodError};
pub use methods::Methods;
pub use settings::MethodSettings;
