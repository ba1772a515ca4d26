//! Which triangles meet along which edges.

/// The half-edges of triangles after joining vertices at the same position. A half-edge is the edge that a triangle
/// walks from one of its corners to the next; that of corner k of triangle t has the number 3 t + k.
#[derive(Clone, Copy)]
pub(crate) struct HalfEdges<'a> {
    pub triangles: &'a [[u32; 3]],
    /// The representative of each vertex.
    pub welded: &'a [u32],
}

impl HalfEdges<'_> {
    pub fn count(self) -> u32 {
        3 * self.triangles.len() as u32
    }

    /// The vertex where a half-edge begins, not welded.
    pub fn vertex(self, half: u32) -> u32 {
        self.triangles[half as usize / 3][half as usize % 3]
    }

    pub fn from(self, half: u32) -> u32 {
        self.welded[self.vertex(half) as usize]
    }

    pub fn to(self, half: u32) -> u32 {
        self.from(next(half))
    }

    fn lower(self, half: u32) -> u32 {
        self.from(half).min(self.to(half))
    }
}

/// The half-edge that follows in the same triangle.
pub(crate) fn next(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

/// What lies on the other side of a half-edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// Nothing: the surface ends here.
    Boundary,
    /// One triangle, whose half-edge runs the opposite way: both face the same side.
    Same(u32),
    /// One triangle, whose half-edge runs the same way: the two face opposite sides.
    Opposite(u32),
    /// Two triangles or more.
    Crowd,
}

/// Half-edges grouped by the edge that they walk.
pub(crate) struct Edges<'a> {
    pub half_edges: HalfEdges<'a>,
    /// What lies beyond each half-edge.
    pub across: Vec<Across>,
    /// The higher end and the number of each half-edge, ascending among those with the same lower end.
    sorted: Vec<(u32, u32)>,
    /// Where the half-edges of each lower end begin in `sorted`; one more entry than there are vertices.
    begins: Vec<u32>,
}

impl<'a> Edges<'a> {
    pub fn new(triangles: &'a [[u32; 3]], welded: &'a [u32]) -> Self {
        let half_edges = HalfEdges { triangles, welded };
        let (sorted, begins) = sort(half_edges);
        let mut edges = Self { half_edges, across: Vec::new(), sorted, begins };
        edges.across = edges.find_across();
        edges
    }

    /// The half-edges of each edge in turn, each with its higher end.
    pub fn groups(&self) -> impl Iterator<Item = &[(u32, u32)]> {
        self.begins.windows(2).flat_map(|ends| self.sorted[range(ends)].chunk_by(|a, b| a.0 == b.0))
    }

    /// Whether a triangle has the edge between two welded vertices.
    pub fn contains(&self, a: u32, b: u32) -> bool {
        let begin = a.min(b) as usize;
        let from_lower = &self.sorted[range(&self.begins[begin..begin + 2])];
        from_lower.binary_search_by_key(&a.max(b), |&(higher, _)| higher).is_ok()
    }

    fn find_across(&self) -> Vec<Across> {
        let mut across = vec![Across::Boundary; self.sorted.len()];
        for group in self.groups() {
            match *group {
                [_] => {}
                [(_, g), (_, h)] => {
                    let same = self.half_edges.from(g) != self.half_edges.from(h);
                    let beyond = if same { Across::Same } else { Across::Opposite };
                    (across[g as usize], across[h as usize]) = (beyond(h), beyond(g));
                }
                _ => group.iter().for_each(|&(_, h)| across[h as usize] = Across::Crowd),
            }
        }
        across
    }
}

/// Sorts by the lower end by counting, then the few half-edges of each lower end.
fn sort(half_edges: HalfEdges<'_>) -> (Vec<(u32, u32)>, Vec<u32>) {
    let mut begins = vec![0; half_edges.welded.len() + 1];
    (0..half_edges.count()).for_each(|h| begins[half_edges.lower(h) as usize + 1] += 1);
    for v in 1..begins.len() {
        begins[v] += begins[v - 1];
    }
    let mut next = begins.clone();
    let mut sorted = vec![(0, 0); half_edges.count() as usize];
    for h in 0..half_edges.count() {
        let place = &mut next[half_edges.lower(h) as usize];
        sorted[*place as usize] = (half_edges.from(h).max(half_edges.to(h)), h);
        *place += 1;
    }
    begins.windows(2).for_each(|ends| sorted[range(ends)].sort_unstable());
    (sorted, begins)
}

fn range(ends: &[u32]) -> std::ops::Range<usize> {
    ends[0] as usize..ends[1] as usize
}
