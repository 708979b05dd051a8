//! Links PETSc and Open MPI; `PETSC_LIB_DIR` says where, if not where the linker looks, `PETSC_LIB` which, if not `petsc_real`.

fn main() {
    for name in ["PETSC_LIB_DIR", "PETSC_LIB"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    if let Ok(directory) = std::env::var("PETSC_LIB_DIR") {
        println!("cargo:rustc-link-search=native={directory}");
    }
    println!("cargo:rustc-link-lib=dylib={}", std::env::var("PETSC_LIB").unwrap_or_else(|_| "petsc_real".to_owned()));
    println!("cargo:rustc-link-lib=dylib=mpi");
}
