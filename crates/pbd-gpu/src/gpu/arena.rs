//! GPU buffers from which ranges are allocated for bodies.

use super::context::Context;
use super::error::GpuError;
use super::stats::GpuMemory;
use super::{encoder, largest_binding};
use range_alloc::RangeAllocator;
use std::ops::Range;
use wgpu::{Buffer, BufferUsages, CommandEncoder};

/// One array of an arena.
#[derive(Debug)]
struct Column {
    name: &'static str,
    /// Bytes of an element.
    stride: u64,
    /// True if growth and moves preserve the content.
    keeps: bool,
    buffer: Buffer,
}

/// Parallel GPU arrays with one range allocator and geometric growth.
#[derive(Debug)]
pub(super) struct Arena {
    columns: Vec<Column>,
    ranges: RangeAllocator<u32>,
}

const USAGE: BufferUsages = BufferUsages::STORAGE
    .union(BufferUsages::COPY_SRC)
    .union(BufferUsages::COPY_DST);

impl Arena {
    /// Creates arrays of `capacity` elements from name, element size \[bytes\] and persistence.
    pub(super) fn new(
        context: &Context,
        columns: &[(&'static str, u64, bool)],
        capacity: u32,
    ) -> Result<Self, GpuError> {
        let column = |&(name, stride, keeps): &(&'static str, u64, bool)| {
            let buffer = context.buffer(name, stride * u64::from(capacity), USAGE)?;
            Ok(Column {
                name,
                stride,
                keeps,
                buffer,
            })
        };
        Ok(Self {
            columns: columns
                .iter()
                .map(column)
                .collect::<Result<_, GpuError>>()?,
            ranges: RangeAllocator::new(0..capacity),
        })
    }

    /// Returns the buffer of an array.
    pub(super) fn buffer(&self, column: usize) -> &Buffer {
        &self.columns[column].buffer
    }

    /// Allocates `len` elements; the result is true if the buffers were replaced by larger ones.
    pub(super) fn allocate(
        &mut self,
        context: &Context,
        len: u32,
    ) -> Result<(Range<u32>, bool), GpuError> {
        if len > u32::MAX / 2 {
            return Err(self.too_large(context, u64::from(len)));
        }
        if let Ok(range) = self.ranges.allocate_range(len) {
            return Ok((range, false));
        }
        self.grow(context, len)?;
        match self.ranges.allocate_range(len) {
            Ok(range) => Ok((range, true)),
            Err(_) => Err(self.too_large(context, u64::from(u32::MAX))),
        }
    }

    /// Frees a range; empty ranges are ignored.
    pub(super) fn free(&mut self, range: Range<u32>) {
        if range.start < range.end {
            self.ranges.free_range(range);
        }
    }

    /// Returns the memory of all arrays.
    pub(super) fn memory(&self) -> GpuMemory {
        let stride: u64 = self.columns.iter().map(|column| column.stride).sum();
        let all = self.ranges.initial_range().end;
        let rented = all - self.ranges.total_available();
        GpuMemory {
            reserved: stride * u64::from(all),
            rented: stride * u64::from(rented),
        }
    }

    /// Moves persistent elements from one range to another.
    ///
    /// Uses a temporary buffer, since WebGPU does not copy within a buffer.
    pub(super) fn move_range(
        &self,
        context: &Context,
        encoder: &mut CommandEncoder,
        from: Range<u32>,
        to: Range<u32>,
    ) -> Result<(), GpuError> {
        for column in self.columns.iter().filter(|column| column.keeps) {
            let bytes = column.stride * u64::from(from.end - from.start);
            let between = context.buffer("moved range", bytes, USAGE)?;
            let at = |element: u32| column.stride * u64::from(element);
            encoder.copy_buffer_to_buffer(&column.buffer, at(from.start), &between, 0, bytes);
            encoder.copy_buffer_to_buffer(&between, 0, &column.buffer, at(to.start), bytes);
        }
        Ok(())
    }

    /// Grows the arrays by at least `len` contiguous elements, and at least twofold.
    fn grow(&mut self, context: &Context, len: u32) -> Result<(), GpuError> {
        let now = self.ranges.initial_range().end;
        let wanted = u64::from(now) + u64::from(now.max(len));
        let stride = self.columns.iter().map(|c| c.stride).max().unwrap_or(1);
        // If the doubled size does not fit, the required size may.
        let most = largest_binding(context) / stride;
        let least = u64::from(now) + u64::from(len);
        let capacity = wanted.min(most).max(least);
        let Ok(end) = u32::try_from(capacity) else {
            return Err(self.too_large(context, capacity));
        };
        let mut encoder = encoder(context, "grow");
        let mut grown = Vec::with_capacity(self.columns.len());
        for column in &self.columns {
            let buffer = context.buffer(column.name, column.stride * capacity, USAGE)?;
            if column.keeps {
                let bytes = column.stride * u64::from(now);
                encoder.copy_buffer_to_buffer(&column.buffer, 0, &buffer, 0, bytes);
            }
            grown.push(buffer);
        }
        context.queue().submit([encoder.finish()]);
        context.check()?;
        for (column, buffer) in self.columns.iter_mut().zip(grown) {
            column.buffer = buffer;
        }
        self.ranges.grow_to(end);
        Ok(())
    }

    fn too_large(&self, context: &Context, elements: u64) -> GpuError {
        let largest = self.columns.iter().max_by_key(|c| c.stride);
        GpuError::BufferTooLarge {
            what: largest.map_or("arena", |c| c.name).to_owned(),
            bytes: largest.map_or(1, |c| c.stride) * elements,
            limit: largest_binding(context),
        }
    }
}

/// Returns the number of elements to allocate for `len`, with slack for later edits.
pub(super) fn with_slack(len: usize) -> u32 {
    let padded = len + len / 4 + 32;
    u32::try_from(padded).unwrap_or(u32::MAX)
}
