//! PVD: a collection of VTU files over time, as ParaView plays it.

use std::path::Path;

use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::vtu::escape;

/// Writes a collection: one entry per file, `(time, file)`, files relative to the collection's own directory. Entries in a row with one time are
/// parts of it, shown together.
///
/// ```
/// # let out = tempfile::tempdir()?;
/// let steps = [(0.0, "iteration_0000.vtu"), (1.0, "iteration_0001.vtu")];
/// nastic_io::write_pvd(out.path().join("iterations.pvd"), &steps)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`WriteError::System`]; [`WriteError::Content`] for a time that is not finite.
pub fn write_pvd<S: AsRef<str>>(path: impl AsRef<Path>, steps: &[(f64, S)]) -> Result<(), WriteError> {
    let path = path.as_ref();
    if let Some((time, file)) = steps.iter().find(|(time, _)| !time.is_finite()) {
        let what = format!("the time of {} is {time}", file.as_ref());
        return Err(WriteError::content(path, what, "times must be finite"));
    }
    write_atomically(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(out, r#"<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">"#)?;
        writeln!(out, "  <Collection>")?;
        let mut before: Option<(f64, usize)> = None;
        for (time, file) in steps {
            let file = escape(file.as_ref());
            let part = before.filter(|(last, _)| last == time).map_or(0, |(_, part)| part + 1);
            before = Some((*time, part));
            writeln!(out, r#"    <DataSet timestep="{time:?}" group="" part="{part}" file="{file}"/>"#)?;
        }
        writeln!(out, "  </Collection>")?;
        writeln!(out, "</VTKFile>")
    })
}
