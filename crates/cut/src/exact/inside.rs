//! Whether a sweep ends inside the body although its boundary pierces no triangle.

pub(super) use crate::inside::starts_inside as is_inside;
