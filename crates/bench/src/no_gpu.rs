//! Stands in for the GPU devices of the benches in builds without the feature `gpu`.

/// The error of opening a GPU in a build without support for it.
#[derive(Debug, thiserror::Error)]
#[error("this build has no GPU support; build it with the feature gpu")]
pub(crate) struct NoGpu;

/// Defines a `Device` that cannot be opened, with the methods that its bench calls.
macro_rules! absent_device {
    ($($method:ident($($argument:ty),*) -> $result:ty;)*) => {
        /// A GPU; this build has none.
        #[derive(Debug)]
        pub(super) enum Device {}

        impl Device {
            pub(super) fn open(_: Option<&str>) -> Result<Self, crate::no_gpu::NoGpu> {
                Err(crate::no_gpu::NoGpu)
            }

            $(pub(super) fn $method(&self, $(_: $argument),*) -> $result {
                match *self {}
            })*
        }
    };
}
pub(crate) use absent_device;
