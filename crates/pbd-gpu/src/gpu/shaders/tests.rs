//! Tests that the composed modules match the Rust side and the default limits of WebGPU.

use super::*;
use crate::gpu::layout::{BodyRecord, Entry, FrameUniform, Link, Motion, PassUniform, Report, Run};
use crate::kernels::arctangent;
use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Literal, Module, TypeInner};

mod pass_order;

/// Default limits of WebGPU.
const STORAGE_BUFFERS: usize = 8;
const WORKGROUP_MEMORY: u32 = 16 * 1024;

fn modules() -> [Module; 3] {
    let sources = [
        passes(WORKGROUP_SIZE, WORKGROUP_SIZE),
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
fn modules_need_no_optional_features() {
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
fn entry_points_match_the_rust_side() {
    let names = |module: &Module| -> Vec<String> {
        let points = module.entry_points.iter();
        points.map(|point| point.name.clone()).collect()
    };
    let [passes, whole, patches] = modules();
    let mut found = names(&passes);
    let mut expected = EntryPoint::ALL.map(EntryPoint::name);
    found.sort();
    expected.sort_unstable();
    assert_eq!(found, expected);
    assert_eq!(names(&whole), [WHOLE_BODY]);
    assert_eq!(names(&patches), [PATCHES, RESET_PATCHES]);
    for (i, point) in EntryPoint::ALL.into_iter().enumerate() {
        assert_eq!(point as usize, i, "the index is the number");
    }
    for point in modules().iter().flat_map(|module| &module.entry_points) {
        assert_eq!(point.workgroup_size, [WORKGROUP_SIZE, 1, 1]);
    }
}

/// Compares size and member offsets of a shader struct with Rust.
fn check_struct(module: &Module, name: &str, size: usize, expected: &[(&str, usize)]) {
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .expect("the struct is in the module");
    let TypeInner::Struct { members, span } = &ty.inner else {
        panic!("{name} is not a struct");
    };
    assert_eq!(*span as usize, size, "size of {name}");
    let found: Vec<(&str, usize)> = members
        .iter()
        .map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize))
        .collect();
    assert_eq!(found, expected, "members of {name}");
}

#[test]
fn structs_have_the_layout_of_rust() {
    let structs = [
        ("Frame", size_of::<FrameUniform>(), FrameUniform::MEMBERS),
        ("Pass", size_of::<PassUniform>(), PassUniform::MEMBERS),
        ("Body", size_of::<BodyRecord>(), BodyRecord::MEMBERS),
        ("Run", size_of::<Run>(), Run::MEMBERS),
        ("Link", size_of::<Link>(), Link::MEMBERS),
        ("Report", size_of::<Report>(), Report::MEMBERS),
        ("Motion", size_of::<Motion>(), Motion::MEMBERS),
    ];
    for module in modules() {
        for (name, size, members) in structs {
            check_struct(&module, name, size, members);
        }
    }
}

#[test]
fn arrays_have_the_strides_and_bindings_of_rust() {
    let arrays = [
        ("positions", size_of::<[f32; 4]>()),
        ("motions", size_of::<Motion>()),
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
                panic!("{name} is not an array");
            };
            assert_eq!(found as usize, stride, "stride of {name}");
        }
    }
}

/// Returns the bits of a constant, or of its elements.
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
fn constants_keep_their_bits() {
    for module in modules() {
        for (name, value) in constants::FLOATS {
            assert_eq!(constant(&module, name), [value.to_bits()], "{name}");
        }
        let coefficients = arctangent::COEFFICIENTS.map(f32::to_bits);
        assert_eq!(constant(&module, "COEFFICIENTS"), coefficients);
    }
}
