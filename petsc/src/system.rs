//! [`Distributed`]: a system of equations as PETSc has it.
#![allow(unsafe_code)] // calls of C

use crate::ffi::{self, Object};
use crate::numbering::Numbering;
use crate::object::{KSP, MAP, MAT, NULL_SPACE, Owned, VEC};
use crate::rows::Rows;
use crate::session::{PetscError, alone, check, count, on_its_thread, world};
use std::ffi::{CStr, c_int};

/// Begins the names of options: `-nastic_pc_type`, `-nastic_ksp_monitor`.
const PREFIX: &CStr = c"nastic_";
/// Iterations of conjugate gradients.
const MOST: c_int = 10_000;

/// How conjugate gradients ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    Converged,
    Indefinite,
    /// All iterations are spent.
    Spent,
    Other(c_int),
}

/// What a solution took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Report {
    pub end: End,
    pub iterations: usize,
    /// Euclidean norm of the residual.
    pub residual: f64,
}

/// `sum_p K_p` by rows over the ranks, from the unassembled shares.
pub(crate) struct Distributed {
    matrix: Owned,
    /// What rigid motions are at the displaced nodes: the near-kernel.
    _motions: Option<Owned>,
    comm: ffi::Comm,
    owned: c_int,
    all: c_int,
    block: c_int,
}

impl Distributed {
    /// Of the share of this rank, whose nodes are at `positions`.
    pub fn new(
        mut rows: Rows,
        numbering: &Numbering,
        (block, positions): (usize, &[[f64; 3]]),
        over_ranks: bool,
    ) -> Result<Self, PetscError> {
        on_its_thread()?;
        let comm = if over_ranks { world() } else { alone() };
        let n = count("unknowns", block * numbering.global.len())?;
        let (owned, all) = (count("unknowns", block * numbering.owned)?, count("unknowns", block * numbering.nodes)?);
        let (bs, nodes) = (count("unknowns", block)?, count("nodes", numbering.global.len())?);
        // SAFETY: all pointers are to arrays of the lengths given that outlive their users: the rows live to the end of this block, in which the matrix that
        // stands on them ends; maps copy their numbers.
        let matrix = unsafe {
            let map = Owned::make(MAP, "ISLocalToGlobalMappingCreate", |map| {
                ffi::ISLocalToGlobalMappingCreate(comm, bs, nodes, numbering.global.as_ptr(), ffi::COPY_VALUES, map)
            })?;
            let unassembled = Owned::make(MAT, "MatCreateIS", |mat| {
                ffi::MatCreateIS(comm, bs, owned, owned, all, all, map.get(), map.get(), mat)
            })?;
            let (i, j, a) = (rows.starts.as_mut_ptr(), rows.columns.as_mut_ptr(), rows.values.as_mut_ptr());
            let local = Owned::make(MAT, "MatCreateSeqAIJWithArrays", |mat| {
                ffi::MatCreateSeqAIJWithArrays(alone(), n, n, i, j, a, mat)
            })?;
            check("MatISSetLocalMat", ffi::MatISSetLocalMat(unassembled.get(), local.get()))?;
            check("MatAssemblyBegin", ffi::MatAssemblyBegin(unassembled.get(), ffi::FINAL_ASSEMBLY))?;
            check("MatAssemblyEnd", ffi::MatAssemblyEnd(unassembled.get(), ffi::FINAL_ASSEMBLY))?;
            Owned::make(MAT, "MatConvert", |mat| {
                ffi::MatConvert(unassembled.get(), c"aij".as_ptr(), ffi::INITIAL_MATRIX, mat)
            })?
        };
        let mut system = Distributed { matrix, _motions: None, comm, owned, all, block: bs };
        if (2..=3).contains(&block) {
            let own = positions.iter().take(numbering.owned);
            let coordinates: Vec<f64> = own.flat_map(|x| &x[..block]).copied().collect();
            system._motions = Some(system.rigid_motions(&coordinates)?);
        }
        Ok(system)
    }

    /// On own unknowns, which the caller keeps as long as the vector.
    fn vector(&self, values: *const f64) -> Result<Owned, PetscError> {
        // SAFETY: as many values as this rank has unknowns, which outlive the vector.
        Owned::make(VEC, "VecCreateMPIWithArray", |vec| unsafe {
            ffi::VecCreateMPIWithArray(self.comm, self.block, self.owned, self.all, values, vec)
        })
    }

    fn rigid_motions(&self, coordinates: &[f64]) -> Result<Owned, PetscError> {
        let places = self.vector(coordinates.as_ptr())?;
        // SAFETY: objects of PETSc that live.
        unsafe {
            let motions = Owned::make(NULL_SPACE, "MatNullSpaceCreateRigidBody", |space| {
                ffi::MatNullSpaceCreateRigidBody(places.get(), space)
            })?;
            check("MatSetNearNullSpace", ffi::MatSetNearNullSpace(self.matrix.get(), motions.get()))?;
            Ok(motions)
        }
    }

    /// A solver with its preconditioner, not set up.
    fn solver(&self) -> Result<(Owned, Object), PetscError> {
        // SAFETY: objects of PETSc that live.
        unsafe {
            let ksp = Owned::make(KSP, "KSPCreate", |ksp| ffi::KSPCreate(self.comm, ksp))?;
            let mut pc = std::ptr::null_mut();
            check("KSPSetOperators", ffi::KSPSetOperators(ksp.get(), self.matrix.get(), self.matrix.get()))?;
            check("KSPGetPC", ffi::KSPGetPC(ksp.get(), &raw mut pc))?;
            Ok((ksp, pc))
        }
    }

    /// `K x = b` to `|b - K x| <= tolerance |b|` by conjugate gradients, on the unknowns that belong to this rank.
    pub fn solve(&self, b: &[f64], x: &mut [f64], tolerance: f64) -> Result<Report, PetscError> {
        let (ksp, pc) = self.solver()?;
        let (b, x) = (self.vector(b.as_ptr())?, self.vector(x.as_mut_ptr())?);
        let (mut reason, mut iterations, mut residual) = (0, 0, 0.0);
        let factor;
        // SAFETY: objects of PETSc that live; x, which it writes to, is borrowed for that.
        unsafe {
            let ksp = ksp.get();
            check("KSPSetType", ffi::KSPSetType(ksp, c"cg".as_ptr()))?;
            check("KSPSetTolerances", ffi::KSPSetTolerances(ksp, tolerance, 1e-300, 1e10, MOST))?;
            check("PCSetType", ffi::PCSetType(pc, c"gamg".as_ptr()))?;
            check("KSPSetOptionsPrefix", ffi::KSPSetOptionsPrefix(ksp, PREFIX.as_ptr()))?;
            check("KSPSetFromOptions", ffi::KSPSetFromOptions(ksp))?;
            if !is_a(ksp, c"cg")? {
                return Err(PetscError::Method { option: "-nastic_ksp_type", only: "cg" });
            }
            // of what a solution is, options decide nothing
            check("KSPSetNormType", ffi::KSPSetNormType(ksp, ffi::NORM_UNPRECONDITIONED))?;
            check("KSPSetTolerances", ffi::KSPSetTolerances(ksp, tolerance, 1e-300, 1e10, ffi::KEEP))?;
            factor = signed_factor(pc)?;
            check("KSPSolve", ffi::KSPSolve(ksp, b.get(), x.get()))?;
            check("KSPGetConvergedReason", ffi::KSPGetConvergedReason(ksp, &raw mut reason))?;
            check("KSPGetIterationNumber", ffi::KSPGetIterationNumber(ksp, &raw mut iterations))?;
            check("KSPGetResidualNorm", ffi::KSPGetResidualNorm(ksp, &raw mut residual))?;
        }
        let end = match (reason, factor) {
            (ffi::CONVERGED_RTOL | ffi::CONVERGED_ATOL, None) => End::Converged,
            // with a factor one iteration solves indefinite systems as well
            (ffi::CONVERGED_RTOL | ffi::CONVERGED_ATOL, Some(factor)) => match inertia(factor)? {
                (0, 0) => End::Converged,
                _ => End::Indefinite,
            },
            (ffi::DIVERGED_INDEFINITE_MAT | ffi::DIVERGED_INDEFINITE_PC, _) => End::Indefinite,
            (ffi::DIVERGED_ITS, _) => End::Spent,
            (other, _) => End::Other(other),
        };
        Ok(Report { end, iterations: iterations.unsigned_abs() as usize, residual })
    }

    /// Negative and zero eigenvalues, of a factor by MUMPS.
    pub fn inertia(&self) -> Result<(usize, usize), PetscError> {
        let (ksp, pc) = self.solver()?;
        // SAFETY: objects of PETSc that live.
        unsafe {
            check("PCSetType", ffi::PCSetType(pc, c"cholesky".as_ptr()))?;
            check("PCFactorSetMatSolverType", ffi::PCFactorSetMatSolverType(pc, c"mumps".as_ptr()))?;
        }
        let factor = signed_factor(pc)?;
        // SAFETY: the same.
        check("KSPSetUp", unsafe { ffi::KSPSetUp(ksp.get()) })?;
        factor.map_or(Ok((0, 0)), inertia)
    }
}

/// Whether an object is of a type.
fn is_a(object: Object, kind: &CStr) -> Result<bool, PetscError> {
    let mut same = 0;
    // SAFETY: an object of PETSc that lives.
    check("PetscObjectTypeCompare", unsafe { ffi::PetscObjectTypeCompare(object, kind.as_ptr(), &raw mut same) })?;
    Ok(same != 0)
}

/// The factor that a preconditioner is, not computed yet and such that signs of its pivots will be counted; `None` of one that is no factor.
fn signed_factor(pc: Object) -> Result<Option<Object>, PetscError> {
    if is_a(pc, c"lu")? {
        return Err(PetscError::Method {
            option: "-nastic_pc_type",
            only: "a factor that shows signs of pivots: cholesky",
        });
    }
    if !is_a(pc, c"cholesky")? {
        return Ok(None);
    }
    let (mut factor, mut kind) = (std::ptr::null_mut(), std::ptr::null());
    // SAFETY: objects of PETSc that live; the factor belongs to the preconditioner, the name to the factor.
    unsafe {
        check("PCFactorSetUpMatSolverType", ffi::PCFactorSetUpMatSolverType(pc))?;
        check("PCFactorGetMatrix", ffi::PCFactorGetMatrix(pc, &raw mut factor))?;
        check("MatFactorGetSolverType", ffi::MatFactorGetSolverType(factor, &raw mut kind))?;
        if CStr::from_ptr(kind) == c"mumps" {
            for number in ffi::MUMPS_COUNTS {
                check("MatMumpsSetIcntl", ffi::MatMumpsSetIcntl(factor, number, 1))?;
            }
        }
    }
    Ok(Some(factor))
}

/// Negative and zero eigenvalues, of a factor.
fn inertia(factor: Object) -> Result<(usize, usize), PetscError> {
    let (mut negative, mut zero, mut positive) = (0, 0, 0);
    // SAFETY: a factor of PETSc that lives.
    let code = unsafe { ffi::MatGetInertia(factor, &raw mut negative, &raw mut zero, &raw mut positive) };
    check("MatGetInertia", code)?;
    Ok((negative.unsigned_abs() as usize, zero.unsigned_abs() as usize))
}
