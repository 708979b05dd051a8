//! What is called of PETSc 3.18 (real numbers, 32-bit indices) and of Open MPI, declared by hand.
#![allow(missing_docs)] // PETSc's manual pages and the MPI standard say what they are
#![allow(non_upper_case_globals, unsafe_code)] // declarations of C

use std::ffi::{c_char, c_double, c_int, c_void};

/// An object of PETSc.
pub type Object = *mut c_void;
/// A communicator of Open MPI.
pub type Comm = *mut c_void;
pub type Code = c_int;

/// The release whose functions and constants these are.
pub const RELEASE: (c_int, c_int) = (3, 18);
/// Of `PetscDataType`.
pub const DOUBLE: c_int = 1;
pub const INT: c_int = 16;
pub const COPY_VALUES: c_int = 0;
pub const INITIAL_MATRIX: c_int = 0;
pub const FINAL_ASSEMBLY: c_int = 0;
/// A tolerance that stays as it is.
pub const KEEP: c_int = -2;
pub const NORM_UNPRECONDITIONED: c_int = 2;
/// Controls of MUMPS that are 1 where signs of pivots are counted: no ScaLAPACK at the root (13), which hides them; null pivots (24).
pub const MUMPS_COUNTS: [c_int; 2] = [13, 24];
pub const CONVERGED_RTOL: c_int = 2;
pub const CONVERGED_ATOL: c_int = 3;
pub const DIVERGED_ITS: c_int = -3;
pub const DIVERGED_INDEFINITE_PC: c_int = -8;
pub const DIVERGED_INDEFINITE_MAT: c_int = -10;

#[repr(C)]
pub struct Status {
    pub source: c_int,
    pub tag: c_int,
    pub error: c_int,
    pub cancelled: c_int,
    pub bytes: usize,
}

unsafe extern "C" {
    // written by PetscInitialize and MPI_Init
    pub static mut PETSC_COMM_WORLD: Comm;
    pub static mut ompi_mpi_comm_self: c_void;
    pub static mut ompi_mpi_byte: c_void;

    pub fn MPI_Comm_rank(comm: Comm, rank: *mut c_int) -> c_int;
    pub fn MPI_Comm_size(comm: Comm, size: *mut c_int) -> c_int;
    pub fn MPI_Send(data: *const c_void, n: c_int, kind: *const c_void, to: c_int, tag: c_int, comm: Comm) -> c_int;
    pub fn MPI_Iprobe(from: c_int, tag: c_int, comm: Comm, flag: *mut c_int, status: *mut Status) -> c_int;
    pub fn MPI_Get_count(status: *const Status, kind: *const c_void, count: *mut c_int) -> c_int;
    pub fn MPI_Recv(
        data: *mut c_void,
        n: c_int,
        kind: *const c_void,
        from: c_int,
        tag: c_int,
        comm: Comm,
        status: *mut Status,
    ) -> c_int;
    pub fn MPI_Abort(comm: Comm, code: c_int) -> c_int;

    pub fn PetscInitialize(
        argc: *mut c_int,
        argv: *mut *mut *mut c_char,
        file: *const c_char,
        help: *const c_char,
    ) -> Code;
    pub fn PetscGetVersionNumber(
        major: *mut c_int,
        minor: *mut c_int,
        subminor: *mut c_int,
        release: *mut c_int,
    ) -> Code;
    pub fn PetscDataTypeGetSize(kind: c_int, size: *mut usize) -> Code;
    pub fn PetscDataTypeFromString(name: *const c_char, kind: *mut c_int, found: *mut c_int) -> Code;
    pub fn PetscFinalize() -> Code;
    pub fn PetscOptionsInsertString(options: Object, text: *const c_char) -> Code;

    pub fn ISLocalToGlobalMappingCreate(
        comm: Comm,
        bs: c_int,
        n: c_int,
        global: *const c_int,
        mode: c_int,
        map: *mut Object,
    ) -> Code;
    pub fn ISLocalToGlobalMappingDestroy(map: *mut Object) -> Code;

    pub fn MatCreateSeqAIJWithArrays(
        comm: Comm,
        m: c_int,
        n: c_int,
        i: *mut c_int,
        j: *mut c_int,
        a: *mut c_double,
        mat: *mut Object,
    ) -> Code;
    pub fn MatCreateIS(
        comm: Comm,
        bs: c_int,
        m: c_int,
        n: c_int,
        mm: c_int,
        nn: c_int,
        rows: Object,
        columns: Object,
        mat: *mut Object,
    ) -> Code;
    pub fn MatISSetLocalMat(mat: Object, local: Object) -> Code;
    pub fn MatAssemblyBegin(mat: Object, kind: c_int) -> Code;
    pub fn MatAssemblyEnd(mat: Object, kind: c_int) -> Code;
    pub fn MatConvert(mat: Object, kind: *const c_char, reuse: c_int, out: *mut Object) -> Code;
    pub fn MatSetNearNullSpace(mat: Object, space: Object) -> Code;
    pub fn MatGetInertia(factor: Object, negative: *mut c_int, zero: *mut c_int, positive: *mut c_int) -> Code;
    pub fn MatFactorGetSolverType(factor: Object, kind: *mut *const c_char) -> Code;
    pub fn MatMumpsSetIcntl(factor: Object, number: c_int, value: c_int) -> Code;
    pub fn MatDestroy(mat: *mut Object) -> Code;
    pub fn MatNullSpaceCreateRigidBody(coordinates: Object, space: *mut Object) -> Code;
    pub fn MatNullSpaceDestroy(space: *mut Object) -> Code;

    pub fn VecCreateMPIWithArray(
        comm: Comm,
        bs: c_int,
        n: c_int,
        nn: c_int,
        data: *const c_double,
        vec: *mut Object,
    ) -> Code;
    pub fn VecDestroy(vec: *mut Object) -> Code;

    pub fn KSPCreate(comm: Comm, ksp: *mut Object) -> Code;
    pub fn KSPSetOptionsPrefix(ksp: Object, prefix: *const c_char) -> Code;
    pub fn KSPSetOperators(ksp: Object, a: Object, p: Object) -> Code;
    pub fn KSPSetType(ksp: Object, kind: *const c_char) -> Code;
    pub fn KSPSetNormType(ksp: Object, kind: c_int) -> Code;
    pub fn KSPSetTolerances(
        ksp: Object,
        relative: c_double,
        absolute: c_double,
        divergence: c_double,
        most: c_int,
    ) -> Code;
    pub fn KSPSetFromOptions(ksp: Object) -> Code;
    pub fn PetscObjectTypeCompare(object: Object, kind: *const c_char, same: *mut c_int) -> Code;
    pub fn KSPGetPC(ksp: Object, pc: *mut Object) -> Code;
    pub fn KSPSetUp(ksp: Object) -> Code;
    pub fn KSPSolve(ksp: Object, b: Object, x: Object) -> Code;
    pub fn KSPGetConvergedReason(ksp: Object, reason: *mut c_int) -> Code;
    pub fn KSPGetIterationNumber(ksp: Object, count: *mut c_int) -> Code;
    pub fn KSPGetResidualNorm(ksp: Object, norm: *mut c_double) -> Code;
    pub fn KSPDestroy(ksp: *mut Object) -> Code;
    pub fn PCSetType(pc: Object, kind: *const c_char) -> Code;
    pub fn PCFactorSetMatSolverType(pc: Object, kind: *const c_char) -> Code;
    pub fn PCFactorSetUpMatSolverType(pc: Object) -> Code;
    pub fn PCFactorGetMatrix(pc: Object, factor: *mut Object) -> Code;
}
