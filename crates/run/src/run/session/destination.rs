//! [`Destination`]: where a command puts its results.

use nastic_result::files::Directory;

/// Where results go.
#[derive(Default)]
pub(crate) struct Destination {
    /// `None` for commands that leave nothing behind unless given a directory.
    pub out: Option<Directory>,
    /// The same where starts write their own files: on any rank.
    pub own_out: Option<Directory>,
    /// Whether results of an earlier program, which went further, stay.
    pub leaves_results: bool,
}
