//! Files of nastic's own that are changed in place: opened without following links.

use crate::error::WriteError;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// Opens a file to add to its end. A link there is not followed.
///
/// # Errors
/// [`WriteError::System`]: it is not there, or no plain file.
pub fn append_to(path: &Path) -> Result<File, WriteError> {
    open(path, OpenOptions::new().append(true)).map_err(|source| WriteError::system(path, source))
}

/// Opens a file that is to be changed, as long as it is a plain one under one name: what a link leads to belongs to somebody else.
pub(crate) fn open(path: &Path, how: &mut OpenOptions) -> io::Result<File> {
    let file = without_links(how).open(path).map_err(|error| if path.is_symlink() { is_link() } else { error })?;
    let found = file.metadata()?;
    if !found.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is no plain file; remove it or give it another name",
        ));
    }
    if names(&found) > 1 || path.is_symlink() { Err(is_link()) } else { Ok(file) }
}

fn is_link() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "it is a link, and what it leads to is not changed; remove the link")
}

#[cfg(unix)]
fn without_links(how: &mut OpenOptions) -> &mut OpenOptions {
    use std::os::unix::fs::OpenOptionsExt;
    // a pipe is not waited for
    how.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK)
}

#[cfg(not(unix))]
fn without_links(how: &mut OpenOptions) -> &mut OpenOptions {
    how
}

/// Under how many names a file is known.
#[cfg(unix)]
fn names(found: &std::fs::Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(found)
}

#[cfg(not(unix))]
fn names(_: &std::fs::Metadata) -> u64 {
    1
}
