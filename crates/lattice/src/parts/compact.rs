//! Short forms of the fields of parts in files.

use super::Link;
use crate::measures::Sums;
use smallvec::SmallVec;

/// Moments: `None` for those of a full cell.
pub(super) mod sums {
    use super::Sums;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::LazyLock;

    static FULL: LazyLock<Sums> = LazyLock::new(Sums::full);

    pub(in crate::parts) fn serialize<S: Serializer>(
        sums: &Sums,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let full: &Sums = &FULL;
        // Bits decide: 0 and -0 are equal numbers.
        let own = (!sums.has_bits_of(full)).then_some(sums);
        own.serialize(to)
    }

    pub(in crate::parts) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Sums, D::Error> {
        let own = Option::deserialize(from)?;
        Ok(own.unwrap_or(*FULL))
    }
}

/// Reaches: `None` for a part that is not small.
pub(super) mod reaches {
    use crate::cell::Measure;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::parts) fn serialize<S: Serializer>(
        reaches: &[f32; 6],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let own = (*reaches != Measure::EMPTY.reaches).then_some(reaches);
        own.serialize(to)
    }

    pub(in crate::parts) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<[f32; 6], D::Error> {
        let own = Option::deserialize(from)?;
        Ok(own.unwrap_or(Measure::EMPTY.reaches))
    }
}

/// Links, as a `Vec` is read: its memory is in proportion to the file.
pub(super) mod links {
    use super::{Link, SmallVec};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::parts) fn serialize<S: Serializer>(
        links: &SmallVec<[Link; 6]>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        links.as_slice().serialize(to)
    }

    pub(in crate::parts) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<SmallVec<[Link; 6]>, D::Error> {
        Ok(SmallVec::from_slice(&Vec::deserialize(from)?))
    }
}
