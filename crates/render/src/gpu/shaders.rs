//! The WGSL modules, each with what all of them share before it.

/// What is behind everything.
pub(super) const BACKGROUND: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/background.wgsl")
);

/// Bodies.
pub(super) const SURFACE: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/surface.wgsl")
);

/// Sheets and lines.
pub(super) const OVERLAY: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/overlay.wgsl")
);

/// Storage buffers that the vertex stage of [`SURFACE`] reads.
pub(super) const STORAGE_BUFFERS: u32 = 3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::uniforms::{BodyUniform, ViewUniform};
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use naga::{AddressSpace, Module, TypeInner};
    use std::mem::{offset_of, size_of};

    fn modules() -> [Module; 3] {
        [BACKGROUND, SURFACE, OVERLAY].map(|source| {
            naga::front::wgsl::parse_str(source)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)))
        })
    }

    #[test]
    fn every_module_is_plain_webgpu() {
        for module in modules() {
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            let checked = validator.validate(&module);
            assert!(checked.is_ok(), "{:?}", checked.err());
        }
    }

    #[test]
    fn storage_buffers_are_as_many_as_are_asked_for() {
        let of = |module: &Module| {
            let variables = module.global_variables.iter();
            let is_storage = |space| matches!(space, AddressSpace::Storage { .. });
            variables.filter(|(_, v)| is_storage(v.space)).count()
        };
        let counts = modules().map(|module| of(&module));
        assert_eq!(counts, [0, STORAGE_BUFFERS as usize, 0]);
    }

    /// Compares a struct of the shaders with members as Rust lays them out; members named pad are one array in Rust.
    fn check_struct(module: &Module, name: &str, size: usize, wanted: &[(&str, usize)]) {
        let mut types = module.types.iter();
        let (_, ty) = types
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
            .expect("the struct is in the module");
        let TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct");
        };
        assert_eq!(*span as usize, size, "size of {name}");
        let found: Vec<(&str, usize)> = members
            .iter()
            .map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize))
            .filter(|(member, _)| !member.starts_with("pad"))
            .collect();
        assert_eq!(found, wanted, "members of {name}");
    }

    macro_rules! members {
        ($ty:ty: $($member:ident)*) => { [$((stringify!($member), offset_of!($ty, $member))),*] };
    }

    #[test]
    fn structs_lie_in_memory_as_in_rust() {
        let modules = modules();
        for module in &modules {
            check_struct(
                module,
                "View",
                size_of::<ViewUniform>(),
                &members!(ViewUniform: clip origin key fill sky top bottom wire viewport wire_width encode),
            );
        }
        check_struct(
            &modules[1],
            "Body",
            size_of::<BodyUniform>(),
            &members!(BodyUniform: inside first_vertex),
        );
    }
}
