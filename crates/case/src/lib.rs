//! From a case to a problem: meshes read, formulas evaluated, names looked up; and what deserves attention in it.

pub mod analysis;
pub mod describe;
pub mod electric;
pub mod expectation;
pub mod film;
pub mod inspect;
pub mod lower;
pub mod output_names;
pub mod part;
pub mod warning;
