//! Commented cases to begin with: `nastic new`.

use nastic_io::{WriteError, write_atomically};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A case with its mesh, for a directory of its own.
#[derive(Debug)]
pub struct Template {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub about: &'static str,
    /// The case, with comments.
    case: &'static str,
    /// The files it names.
    files: &'static [(&'static str, &'static [u8])],
}

/// All of them.
pub const TEMPLATES: &[Template] = &[
    Template {
        name: "finger",
        about: "a finger bent by a muscle: the tension of every cell that brings its end to a target",
        case: include_str!("../templates/finger.json"),
        files: &[],
    },
    Template {
        name: "chamber",
        about: "a finger with an air chamber: the pressure that bends it to a target",
        case: include_str!("../templates/chamber.json"),
        files: &[("finger.msh", include_bytes!("../templates/finger.msh"))],
    },
    Template {
        name: "gripper",
        about: "a finger grips a soft block and lifts it: its path in time",
        case: include_str!("../templates/gripper.json"),
        files: &[],
    },
    Template {
        name: "grasp_3d",
        about: "a tendon finger grasps a block in space and lifts it by friction: the tension in time",
        case: include_str!("../templates/grasp_3d.json"),
        files: &[],
    },
    Template {
        name: "tendon_finger",
        about: "a finger with a flexor and an extensor: the tensions that bring its end to a target",
        case: include_str!("../templates/tendon_finger.json"),
        files: &[],
    },
    Template {
        name: "fiber_reinforced",
        about: "an inflated tube wound with fibres: the pressure that turns its end",
        case: include_str!("../templates/fiber_reinforced.json"),
        files: &[("tube.msh", include_bytes!("../templates/tube.msh"))],
    },
    Template {
        name: "magnet",
        about: "a magnetic strip: remanence and field that lift its end",
        case: include_str!("../templates/magnet.json"),
        files: &[],
    },
    Template {
        name: "layout",
        about: "a beam cast of two silicones: where the stiff one stands, so that its end sinks least",
        case: include_str!("../templates/layout.json"),
        files: &[],
    },
    Template {
        name: "growth",
        about: "a strip that grows into a wave: by which part in every place",
        case: include_str!("../templates/growth.json"),
        files: &[],
    },
    Template {
        name: "robust",
        about: "a finger of uncertain stiffness: one tension for all scenarios",
        case: include_str!("../templates/robust.json"),
        files: &[],
    },
];

/// Why a template was not written.
#[derive(Debug, Error)]
pub enum TemplateError {
    /// No template has this name.
    #[error("there is no template \"{name}\"; take one of {}", names())]
    Unknown {
        /// The name asked for.
        name: String,
    },
    /// Nothing is replaced.
    #[error("{} exists already and is left as it is: choose another name", path.display())]
    Exists {
        /// The directory.
        path: PathBuf,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

fn names() -> String {
    TEMPLATES.iter().map(|template| template.name).collect::<Vec<_>>().join(", ")
}

impl Template {
    /// The template of that name.
    ///
    /// # Errors
    /// [`TemplateError::Unknown`] with the names there are.
    pub fn named(name: &str) -> Result<&'static Self, TemplateError> {
        let found = TEMPLATES.iter().find(|template| template.name == name);
        found.ok_or_else(|| TemplateError::Unknown { name: name.to_owned() })
    }

    /// Writes the case and its files into a new directory; the case file, called as the directory.
    ///
    /// # Errors
    /// [`TemplateError::Exists`] where there is anything of that name; [`TemplateError::Write`].
    pub fn write(&self, directory: &Path) -> Result<PathBuf, TemplateError> {
        if directory.symlink_metadata().is_ok() {
            return Err(TemplateError::Exists { path: directory.to_owned() });
        }
        // what appears there meanwhile is left as it is too
        let fail = |source| WriteError::System { file: directory.to_owned(), source };
        if let Some(parent) = directory.parent() {
            std::fs::create_dir_all(parent).map_err(fail)?;
        }
        std::fs::create_dir(directory).map_err(fail)?;
        for (name, content) in self.files {
            write_atomically(directory.join(name), |out| out.write_all(content))?;
        }
        let stem = directory.file_name().map_or_else(|| self.name.into(), |name| name.to_string_lossy().into_owned());
        let case = directory.join(format!("{stem}.json"));
        write_atomically(&case, |out| out.write_all(self.case.as_bytes()))?;
        Ok(case)
    }
}
