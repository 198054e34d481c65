//! [`Set`]: a set of small numbers, which is emptied in the time of its members.

/// A set of numbers, with its members in the order in which they were added.
#[derive(Debug, Default)]
pub(crate) struct Set {
    is_member: Vec<bool>,
    pub(crate) members: Vec<u32>,
}

impl Set {
    /// Empties the set and makes room for numbers below `count`.
    pub(crate) fn reset(&mut self, count: usize) {
        self.clear();
        self.is_member
            .resize(count.max(self.is_member.len()), false);
    }

    /// Adds a number below the count. Returns whether it is new.
    pub(crate) fn insert(&mut self, number: u32) -> bool {
        match self.is_member.get_mut(number as usize) {
            Some(is_member) if !*is_member => {
                *is_member = true;
                self.members.push(number);
                true
            }
            _ => false,
        }
    }

    pub(crate) fn contains(&self, number: u32) -> bool {
        self.is_member.get(number as usize) == Some(&true)
    }

    pub(crate) fn clear(&mut self) {
        for number in self.members.drain(..) {
            self.is_member[number as usize] = false;
        }
    }
}
