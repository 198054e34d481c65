//! The composed modules against the Rust side and against what every WebGPU device can do.

use super::*;
use crate::gpu::layout::{BodyRecord, Entry, FrameUniform, Link, PassUniform, Report, Run};
use crate::kernels::{arctangent, bending, tethers, volume};
use crate::struts;
use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Literal, Module, TypeInner};
use std::mem::{offset_of, size_of};

/// What a device must have: WebGPU's default limits.
const STORAGE_BUFFERS: usize = 8;
const WORKGROUP_MEMORY: u32 = 16 * 1024;

fn modules() -> [Module; 3] {
    let sources = [
        colors(WORKGROUP_SIZE, WORKGROUP_SIZE),
        whole_body(WORKGROUP_SIZE, CAPACITY),
        patches(WORKGROUP_SIZE),
    ];
    sources.map(|source| {
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)))
    })
}

fn is_storage(space: AddressSpace) -> bool {
    matches!(space, AddressSpace::Storage { .. })
}

#[test]
fn every_module_is_plain_webgpu() {
    for module in modules() {
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let checked = validator.validate(&module);
        assert!(checked.is_ok(), "{:?}", checked.err());
        let buffers = module.global_variables.iter();
        let buffers = buffers.filter(|(_, v)| is_storage(v.space)).count();
        assert!(buffers <= STORAGE_BUFFERS, "{buffers} storage buffers");
        let mut layouter = Layouter::default();
        layouter.update(module.to_ctx()).unwrap();
        let memory: u32 = module
            .global_variables
            .iter()
            .filter(|(_, v)| v.space == AddressSpace::WorkGroup)
            .map(|(_, v)| layouter[v.ty].size.next_multiple_of(16))
            .sum();
        assert!(memory <= WORKGROUP_MEMORY, "{memory} bytes a workgroup");
    }
}

#[test]
fn entry_points_are_those_that_the_rust_side_knows() {
    let names = |module: &Module| -> Vec<String> {
        let points = module.entry_points.iter();
        points.map(|point| point.name.clone()).collect()
    };
    let [colors, whole, patches] = modules();
    let mut found = names(&colors);
    let mut wanted = EntryPoint::ALL.map(EntryPoint::name);
    found.sort();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
    assert_eq!(names(&whole), [WHOLE_BODY]);
    assert_eq!(names(&patches), [PATCHES, RESET_PATCHES]);
    for (i, point) in EntryPoint::ALL.into_iter().enumerate() {
        assert_eq!(point as usize, i, "numbers are places");
    }
    for point in modules().iter().flat_map(|module| &module.entry_points) {
        assert_eq!(point.workgroup_size, [WORKGROUP_SIZE, 1, 1]);
    }
}

/// Compares a struct of the shaders with members as Rust lays them out; members named pad are one
/// array in Rust.
fn check_struct(module: &Module, name: &str, size: usize, wanted: &[(&str, usize)]) {
    let (_, ty) = module
        .types
        .iter()
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
    for module in modules() {
        let check = |name, size, wanted: &[_]| check_struct(&module, name, size, wanted);
        check(
            "Frame",
            size_of::<FrameUniform>(),
            &members!(FrameUniform: gravity_step h ground has_ground substeps iterations notes_motion own_weight),
        );
        check(
            "Pass",
            size_of::<PassUniform>(),
            &members!(PassUniform: first_link links kind color colors with_overflow substep),
        );
        check(
            "Body",
            size_of::<BodyRecord>(),
            &members!(BodyRecord: first_vertex vertices first_pin pins first_tether tethers stretch_factor stretch_alpha stretch_old
                bending_factor bending_alpha bending_old kept_velocity friction flags first_run stretch_colors
                bending_colors patch_tables patches first_piece pieces first_chunk chunks first_spoke first_corner corners
                volume_alpha volume_pressure volume_returned volume_old strut_colors strut_factor strut_alpha strut_old contacts first_collider colliders),
        );
        check("Run", size_of::<Run>(), &members!(Run: first len));
        check("Link", size_of::<Link>(), &members!(Link: first_group body));
        check(
            "Report",
            size_of::<Report>(),
            &members!(Report: lowest box_min box_max bad_vertex bad_substep farthest),
        );
    }
}

#[test]
fn arrays_have_the_strides_and_bindings_that_rust_fills() {
    let arrays = [
        ("positions", size_of::<[f32; 4]>()),
        ("velocities", size_of::<[f32; 4]>()),
        ("displacements", size_of::<[f32; 4]>()),
        ("constraints", size_of::<Entry>()),
        ("bodies", size_of::<BodyRecord>()),
        ("runs", size_of::<Run>()),
        ("links", size_of::<Link>()),
        ("reports", size_of::<Report>()),
    ];
    for module in modules() {
        for (_, variable) in module.global_variables.iter() {
            if !is_storage(variable.space) {
                continue;
            }
            let name = variable.name.as_deref().unwrap_or("");
            let binding = variable.binding.unwrap();
            let (wanted, stride) = arrays[binding.binding as usize];
            assert_eq!((binding.group, name), (0, wanted));
            let TypeInner::Array { stride: found, .. } = module.types[variable.ty].inner else {
                panic!("{name} is no array");
            };
            assert_eq!(found as usize, stride, "stride of {name}");
        }
    }
}

/// The bits of the numbers that a constant consists of.
fn constant(module: &Module, name: &str) -> Vec<u32> {
    let mut constants = module.constants.iter();
    let (_, constant) = constants
        .find(|(_, c)| c.name.as_deref() == Some(name))
        .expect("the constant is in the module");
    let number = |at| match module.global_expressions[at] {
        Expression::Literal(Literal::F32(value)) => value.to_bits(),
        ref other => panic!("{name} holds {other:?}"),
    };
    match &module.global_expressions[constant.init] {
        Expression::Compose { components, .. } => components.iter().copied().map(number).collect(),
        _ => vec![number(constant.init)],
    }
}

#[test]
fn kernels_and_their_twins_have_the_same_constants() {
    use std::f32::consts::{FRAC_PI_2, PI, TAU};
    for module in modules() {
        for (name, wanted) in [
            ("PI", PI),
            ("TAU", TAU),
            ("HALF_PI", FRAC_PI_2),
            ("FLAT", bending::FLAT),
            ("MAX_TURN", bending::MAX_TURN),
            ("RECOVERY", bending::RECOVERY),
            ("HOLD", bending::HOLD),
            ("FOLLOW", bending::FOLLOW),
            ("FREE", bending::FREE),
            ("LIMP", bending::LIMP),
            ("RETURN", tethers::RETURN),
            ("FIRM", bending::FIRM),
            ("STRUT_OWN_WEIGHT", struts::OWN_WEIGHT),
        ] {
            assert_eq!(constant(&module, name), [wanted.to_bits()], "{name}");
        }
        // A patch does not know the volume of the piece that it is a part of.
        if module.entry_points[0].name != PATCHES {
            for (name, wanted) in [("SIXTH", volume::SIXTH), ("THIRD", volume::THIRD)] {
                assert_eq!(constant(&module, name), [wanted.to_bits()], "{name}");
            }
        }
        let coefficients = arctangent::COEFFICIENTS.map(f32::to_bits);
        assert_eq!(constant(&module, "COEFFICIENTS"), coefficients);
    }
}
