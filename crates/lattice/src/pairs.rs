//! Maps in files: lists of pairs, ascending.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

pub(crate) fn serialize<S: Serializer, V: Serialize>(
    map: &BTreeMap<u32, V>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(map)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>, V: Deserialize<'de>>(
    deserializer: D,
) -> Result<BTreeMap<u32, V>, D::Error> {
    let pairs = Vec::<(u32, V)>::deserialize(deserializer)?;
    Ok(pairs.into_iter().collect())
}
