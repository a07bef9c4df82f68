//! Samples that wait for the radio: at most `N`, the oldest give way, and the sequence numbers show it.

/// A ring.
#[derive(Clone, Copy, Debug)]
pub struct Queue<T: Copy + Default, const N: usize> {
    items: [T; N],
    first: usize,
    length: usize,
}

impl<T: Copy + Default, const N: usize> Default for Queue<T, N> {
    fn default() -> Self {
        Queue { items: [T::default(); N], first: 0, length: 0 }
    }
}

impl<T: Copy + Default, const N: usize> Queue<T, N> {
    /// Adds one; returns false where the oldest had to go.
    pub fn push(&mut self, item: T) -> bool {
        if N == 0 {
            return false;
        }
        let room = self.length < N;
        if !room {
            self.drop_first(1);
        }
        let place = (self.first + self.length) % N;
        if let Some(slot) = self.items.get_mut(place) {
            *slot = item;
            self.length += 1;
        }
        room
    }

    /// The k-th from the front.
    pub fn get(&self, k: usize) -> Option<T> {
        if k < self.length { self.items.get((self.first + k) % N).copied() } else { None }
    }

    /// How many wait.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Removes from the front.
    pub fn drop_first(&mut self, count: usize) {
        let count = count.min(self.length);
        if N > 0 {
            self.first = (self.first + count) % N;
        }
        self.length -= count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_give_way() {
        let mut queue = Queue::<u32, 4>::default();
        assert!((0..4).all(|k| queue.push(k)));
        assert!(!queue.push(4));
        assert_eq!(
            (0..5).map(|k| queue.get(k)).collect::<Vec<_>>(),
            [Some(1), Some(2), Some(3), Some(4), None]
        );
        queue.drop_first(3);
        assert_eq!((queue.len(), queue.get(0)), (1, Some(4)));
        queue.drop_first(9);
        assert_eq!(queue.len(), 0);
    }
}
