//! A list for every cell, all in one.

/// Items cell by cell.
pub(super) struct Lists<T> {
    /// Where each cell's items begin.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Lists<T> {
    /// `tell` names all items to whom it is given, twice over, with the cells they are in.
    pub fn new(cells: usize, tell: impl Fn(&mut dyn FnMut(usize, T))) -> Self {
        let mut starts = vec![0u32; cells + 1];
        tell(&mut |cell, _| starts[cell] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut items = vec![T::default(); sum as usize];
        // From the end of each cell's list to its start.
        tell(&mut |cell, item| {
            starts[cell] -= 1;
            items[starts[cell] as usize] = item;
        });
        Self { starts, items }
    }

    #[inline]
    pub fn of(&self, cell: usize) -> &[T] {
        &self.items[self.range(cell)]
    }

    fn range(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    pub fn cells(&self) -> std::ops::Range<usize> {
        0..self.starts.len() - 1
    }
}

#[cfg(test)]
impl<T: Copy + Default> Lists<T> {
    /// Items of all cells.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Puts an item in the place of every hundredth.
    pub fn damage(&mut self, item: T) {
        self.items.iter_mut().step_by(100).for_each(|each| *each = item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_what_they_were_told() {
        let told = [(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd')];
        let lists = Lists::new(5, |each| told.iter().for_each(|&(cell, item)| each(cell, item)));
        for cell in lists.cells() {
            let mut found = lists.of(cell).to_vec();
            found.sort_unstable();
            let expected: Vec<char> = told.iter().filter(|each| each.0 == cell).map(|each| each.1).collect();
            assert_eq!(found, expected, "{cell}");
        }
        assert_eq!(lists.cells(), 0..5);
    }
}
