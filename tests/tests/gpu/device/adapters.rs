//! Enumeration and opening of adapters, and their errors.

use incise_pbd_gpu::{AdapterKind, AdapterRequest, Context, GpuError, adapters, wgpu};
use incise_test_support::external_device::{open, same_adapter};
use incise_test_support::gpu::Needs;

/// Adapters are listed, chosen and refused.
pub(super) fn chosen(context: &Context) {
    unknown_name();
    order();
    by_name();
    unasked();
    too_large_a_need();
    portable();
    small(context);
}

fn unknown_name() {
    let asked = Some("no such device".to_owned());
    let request = AdapterRequest {
        name: asked.clone(),
        ..AdapterRequest::default()
    };
    let error = Context::open(&request).expect_err("none is named so");
    let found: Vec<String> = adapters().into_iter().map(|a| a.name).collect();
    let text = error.to_string();
    assert!(
        found.iter().all(|name| text.contains(name)),
        "{text} names {found:?}"
    );
    assert_eq!(error, GpuError::NoAdapter { asked, found });
}

fn order() {
    let found = adapters();
    assert_eq!(found, adapters(), "the second time too");
    assert!(
        found.is_sorted_by_key(|adapter| adapter.kind),
        "software comes last: {found:?}"
    );
}

fn by_name() {
    for adapter in adapters().into_iter().filter(|a| a.refusal.is_none()) {
        let part = adapter.name[..adapter.name.len().min(8)].to_uppercase();
        let request = AdapterRequest {
            name: Some(part.clone()),
            ..AdapterRequest::default()
        };
        let context = Context::open(&request).expect("it was listed as usable");
        let opened = context.adapter();
        let is_strict = opened.name.contains("SwiftShader");
        assert!(!is_strict || opened.kind == AdapterKind::Software);
        assert!(
            opened.name.to_uppercase().contains(&part),
            "{part} gave {opened:?}"
        );
    }
}

fn unasked() {
    let found = adapters();
    let real = found.iter().find(|a| a.kind != AdapterKind::Software);
    match (Context::open(&AdapterRequest::default()), real) {
        (Ok(context), Some(real)) => assert_eq!(context.adapter(), real),
        (Err(error), None) => {
            let found = found.into_iter().map(|a| a.name).collect();
            assert_eq!(error, GpuError::NoAdapter { asked: None, found });
        }
        (opened, real) => panic!("there is {real:?}, opened {opened:?}"),
    }
}

fn too_large_a_need() {
    let need = 1 << 60;
    let request = AdapterRequest {
        storage_binding: need,
        ..Needs::AnyDevice.request()
    };
    let error = Context::open(&request).expect_err("an exabyte");
    let largest = adapters()[0].limits.storage_binding;
    assert_eq!(
        error,
        GpuError::LimitTooSmall {
            adapter: adapters()[0].name.clone(),
            name: "max_storage_buffer_binding_size",
            need,
            have: largest
        }
    );
}

fn portable() {
    let context = Context::open(&Needs::AnyDevice.portable_request())
        .expect("every adapter has these limits");
    assert_eq!(context.device().limits(), wgpu::Limits::default());
    let request = AdapterRequest {
        storage_binding: (128 << 20) + 4,
        ..Needs::AnyDevice.portable_request()
    };
    // The adapter is opened with lower limits, so the device is too small.
    let error = Context::open(&request).expect_err("a portable binding is smaller");
    assert!(
        matches!(error, GpuError::LimitTooSmall { need, .. } if need == request.storage_binding),
        "{error:?}"
    );
}

fn small(context: &Context) {
    let adapter = same_adapter(context);
    let (device, queue) = open(&adapter, wgpu::Limits::downlevel_defaults());
    let small = Context::from_device(&adapter, device, queue);
    assert!(
        matches!(
            small,
            Err(GpuError::LimitTooSmall {
                need: 8,
                have: 4,
                ..
            })
        ),
        "{small:?}"
    );
    let (device, queue) = open(&adapter, wgpu::Limits::default());
    let shared = Context::from_device(&adapter, device, queue).expect("this is enough");
    assert_eq!(shared.adapter(), context.adapter());
}
