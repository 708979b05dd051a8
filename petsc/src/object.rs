//! [`Owned`]: an object of PETSc that ends with its owner.
#![allow(unsafe_code)] // calls of C

use crate::ffi::{self, Code, Object};
use crate::session::{PetscError, check};
use std::ptr::null_mut;

/// An object with what destroys it.
pub(crate) struct Owned {
    object: Object,
    destroy: unsafe extern "C" fn(*mut Object) -> Code,
}

pub(crate) const MAT: Kind = ffi::MatDestroy;
pub(crate) const VEC: Kind = ffi::VecDestroy;
pub(crate) const KSP: Kind = ffi::KSPDestroy;
pub(crate) const MAP: Kind = ffi::ISLocalToGlobalMappingDestroy;
pub(crate) const NULL_SPACE: Kind = ffi::MatNullSpaceDestroy;

/// What destroys objects of a kind.
pub(crate) type Kind = unsafe extern "C" fn(*mut Object) -> Code;

impl Owned {
    /// What `make` puts into its argument.
    pub fn make(destroy: Kind, call: &'static str, make: impl FnOnce(*mut Object) -> Code) -> Result<Self, PetscError> {
        let mut object = null_mut();
        check(call, make(&raw mut object))?;
        Ok(Owned { object, destroy })
    }

    pub fn get(&self) -> Object {
        self.object
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: made by PETSc, and destroyed once; owners live within a call on PETSc's thread.
        unsafe { (self.destroy)(&raw mut self.object) };
    }
}
