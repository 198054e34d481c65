//! Lets the extension module link without Python, which provides its symbols when it is imported.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
