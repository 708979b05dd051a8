//! Link arguments of a module that an interpreter loads: macOS needs an option for symbols that Python defines.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
