//! 3MF: closed bodies of several materials in one file, for slicers and printers.

use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::vtu::escape;
use nastic_mesh::ClosedSurface;
use std::io::{self, Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// A body of one material.
#[derive(Clone, Debug)]
pub struct PrintedBody {
    /// Its name.
    pub name: String,
    /// The name of what it is made of.
    pub material: String,
    /// Its surface.
    pub surface: ClosedSurface,
}

/// Colours of the bodies on a screen, in their order.
const COLOURS: [&str; 6] = ["#4C78A8", "#F58518", "#54A24B", "#E45756", "#72B7B2", "#B279A2"];
const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Writes bodies that stand as they do to each other: an object each with its material, in millimetres, coordinates multiplied by `scale`.
///
/// Source: 3MF Consortium, 3D Manufacturing Format, core specification 1.3.0.
///
/// # Errors
///
/// [`WriteError::System`]; [`WriteError::Content`] for a coordinate that is not finite, or a body without triangles.
pub fn write_3mf(path: impl AsRef<Path>, title: &str, bodies: &[PrintedBody], scale: f64) -> Result<(), WriteError> {
    let path = path.as_ref();
    for body in bodies {
        if let Some(point) = body.surface.points.iter().find(|point| !point.iter().all(|x| (*x * scale).is_finite())) {
            return Err(WriteError::content(path, format!("a point is {point:?}"), "coordinates must be finite"));
        }
        if body.surface.triangles.is_empty() {
            let what = format!("the body {} has no triangles", body.name);
            return Err(WriteError::content(path, what, "leave it out"));
        }
    }
    write_atomically(path, |out| {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        // the same bytes for the same content: the archive knows no clock
        let file = SimpleFileOptions::default();
        let file = file.compression_method(CompressionMethod::Deflated).last_modified_time(DateTime::default());
        archive.start_file("[Content_Types].xml", file)?;
        archive.write_all(CONTENT_TYPES.as_bytes())?;
        archive.start_file("_rels/.rels", file)?;
        archive.write_all(RELATIONS.as_bytes())?;
        archive.start_file("3D/3dmodel.model", file)?;
        model(&mut io::BufWriter::new(&mut archive), title, bodies, scale)?;
        out.write_all(archive.finish()?.get_ref())
    })
}

/// Number 1 is the list of materials, bodies follow, then what they make up.
fn model(out: &mut dyn Write, title: &str, bodies: &[PrintedBody], scale: f64) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#
    )?;
    writeln!(
        out,
        r#"<metadata name="Title">{}</metadata><metadata name="Application">nastic</metadata>"#,
        escape(title)
    )?;
    writeln!(out, r#"<resources><basematerials id="1">"#)?;
    for (body, colour) in bodies.iter().zip(COLOURS.iter().cycle()) {
        writeln!(out, r#"<base name="{}" displaycolor="{colour}"/>"#, escape(&body.material))?;
    }
    writeln!(out, "</basematerials>")?;
    for (k, body) in bodies.iter().enumerate() {
        let (id, name) = (k + 2, escape(&body.name));
        writeln!(out, r#"<object id="{id}" type="model" name="{name}" pid="1" pindex="{k}"><mesh><vertices>"#)?;
        for point in &body.surface.points {
            let [x, y, z] = point.map(|x| x * scale);
            writeln!(out, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#)?;
        }
        writeln!(out, "</vertices><triangles>")?;
        for [a, b, c] in &body.surface.triangles {
            writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
        }
        writeln!(out, "</triangles></mesh></object>")?;
    }
    let whole = bodies.len() + 2;
    writeln!(out, r#"<object id="{whole}" type="model" name="{}"><components>"#, escape(title))?;
    for k in 0..bodies.len() {
        writeln!(out, r#"<component objectid="{}"/>"#, k + 2)?;
    }
    writeln!(out, r#"</components></object></resources><build><item objectid="{whole}"/></build></model>"#)?;
    out.flush()
}
