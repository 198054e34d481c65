//! The WGSL modules, each with the shared declarations of `view.wgsl` first.

/// Background.
pub(super) const BACKGROUND: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/background.wgsl")
);

/// Bodies.
pub(super) const SURFACE: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/surface.wgsl")
);

/// Overlay triangles and lines.
pub(super) const OVERLAY: &str = concat!(
    include_str!("shaders/view.wgsl"),
    include_str!("shaders/overlay.wgsl")
);

/// Number of storage buffers in the vertex stage of [`SURFACE`].
pub(super) const STORAGE_BUFFERS: u32 = 4;

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
    fn modules_are_valid_without_extensions() {
        for module in modules() {
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            let checked = validator.validate(&module);
            assert!(checked.is_ok(), "{:?}", checked.err());
        }
    }

    #[test]
    fn storage_buffer_count_matches_the_constant() {
        let of = |module: &Module| {
            let variables = module.global_variables.iter();
            let is_storage = |space| matches!(space, AddressSpace::Storage { .. });
            variables.filter(|(_, v)| is_storage(v.space)).count()
        };
        let counts = modules().map(|module| of(&module));
        assert_eq!(counts, [0, STORAGE_BUFFERS as usize, 0]);
    }

    /// Compares size and member offsets of a WGSL struct with its Rust counterpart.
    ///
    /// WGSL members whose names start with `pad` are skipped: they are one array in Rust.
    fn check_struct(module: &Module, name: &str, size: usize, expected: &[(&str, usize)]) {
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
        assert_eq!(found, expected, "members of {name}");
    }

    macro_rules! members {
        ($ty:ty: $($member:ident)*) => { [$((stringify!($member), offset_of!($ty, $member))),*] };
    }

    #[test]
    fn struct_layouts_match_rust() {
        let modules = modules();
        for module in &modules {
            check_struct(
                module,
                "View",
                size_of::<ViewUniform>(),
                &members!(ViewUniform:
                    clip origin key fill sky top bottom wire viewport wire_width encode),
            );
        }
        check_struct(
            &modules[1],
            "Body",
            size_of::<BodyUniform>(),
            &members!(BodyUniform: back_face first_vertex checkers),
        );
    }
}
