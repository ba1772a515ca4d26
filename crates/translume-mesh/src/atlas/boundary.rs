//! Where the boundary of a flat chart meets itself.

use std::collections::HashMap;

use glam::DVec2;

/// The boundary of a chart: the edges that one triangle alone has.
pub(super) struct Boundary {
    edges: Vec<[u32; 2]>,
    /// The vertices on it, each once.
    pub points: Vec<u32>,
    /// The triangles at each vertex of the boundary.
    fans: HashMap<u32, Vec<[u32; 2]>>,
}

impl Boundary {
    pub fn of(triangles: &[[u32; 3]], points: usize) -> Self {
        let mut open: HashMap<[u32; 2], bool> = HashMap::with_capacity(triangles.len() * 2);
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        for [a, b] in triangles.iter().flat_map(sides) {
            open.entry([a.min(b), a.max(b)]).and_modify(|open| *open = false).or_insert(true);
        }
        let edges: Vec<[u32; 2]> =
            triangles.iter().flat_map(sides).filter(|[a, b]| open[&[*a.min(b), *a.max(b)]]).collect();
        let mut on = vec![false; points];
        edges.iter().flatten().for_each(|&v| on[v as usize] = true);
        let mut fans: HashMap<u32, Vec<[u32; 2]>> = HashMap::new();
        for &[a, b, c] in triangles {
            for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                if on[v as usize] {
                    fans.entry(v).or_default().push([from, to]);
                }
            }
        }
        let points = (0..points as u32).filter(|&v| on[v as usize]).collect();
        Self { edges, points, fans }
    }

    /// Vertices of boundary edges that cross or touch another, and of triangles that wrap around a vertex more than once.
    pub fn meetings(&self, points: &[DVec2]) -> Vec<u32> {
        let mut met = Vec::new();
        let at = |v: u32| points[v as usize];
        let mut spans: Vec<_> = self.edges.iter().map(|&e| Span::new(e, e.map(at))).collect();
        spans.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
        for (k, first) in spans.iter().enumerate() {
            let near = spans[k + 1..].iter().take_while(|second| second.low.x <= first.high.x);
            for second in near.filter(|second| first.meets(second)) {
                met.extend(first.edge.into_iter().chain(second.edge));
            }
        }
        for (&v, fan) in &self.fans {
            let angle = |&[from, to]: &[u32; 2]| (at(from) - at(v)).angle_to(at(to) - at(v));
            if fan.iter().map(angle).sum::<f64>() > std::f64::consts::TAU {
                met.push(v);
                met.extend(fan.iter().flatten());
            }
        }
        met
    }
}

/// A boundary edge and the box around it.
struct Span {
    edge: [u32; 2],
    ends: [DVec2; 2],
    low: DVec2,
    high: DVec2,
}

impl Span {
    fn new(edge: [u32; 2], ends: [DVec2; 2]) -> Self {
        Self { edge, ends, low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) }
    }

    /// Whether two edges without a common end cross or touch.
    fn meets(&self, other: &Self) -> bool {
        let apart = self.low.cmpgt(other.high).any() || other.low.cmpgt(self.high).any();
        let joined = self.edge.iter().any(|v| other.edge.contains(v));
        let side = |of: &Self, p: DVec2| (of.ends[1] - of.ends[0]).perp_dot(p - of.ends[0]);
        let splits = |of: &Self, by: &Self| side(of, by.ends[0]) * side(of, by.ends[1]) <= 0.0;
        !apart && !joined && splits(self, other) && splits(other, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of two triangles a step along a path, half a unit to either side.
    fn strip(path: &[DVec2]) -> (Vec<[u32; 3]>, Vec<DVec2>) {
        let steps = path.len() as u32 - 1;
        let triangles =
            (0..steps).map(|k| 2 * k).flat_map(|a| [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]).collect();
        let points = (0..path.len()).flat_map(|k| {
            let along = (path[(k + 1).min(path.len() - 1)] - path[k.saturating_sub(1)]).normalize();
            [path[k] - 0.5 * along.perp(), path[k] + 0.5 * along.perp()]
        });
        (triangles, points.collect())
    }

    fn meetings(path: &[[f64; 2]]) -> usize {
        let (triangles, points) = strip(&path.iter().map(|&p| p.into()).collect::<Vec<_>>());
        Boundary::of(&triangles, points.len()).meetings(&points).len()
    }

    #[test]
    fn a_strip_meets_itself_only_where_it_comes_back() {
        let turn = [[0.0, 0.0], [3.0, 0.0], [6.0, 0.0], [6.0, 3.0], [3.0, 3.0], [2.0, 2.5]];
        assert_eq!(meetings(&turn), 0);
        let mut crossing = turn.to_vec();
        crossing.push([1.5, -2.0]);
        assert!(meetings(&crossing) > 0);
    }

    #[test]
    fn a_fan_that_wraps_around_its_vertex_is_noticed() {
        let fan = |turns: f64| {
            let rim = |k: u32| DVec2::from_angle(std::f64::consts::TAU * turns * f64::from(k) / 12.0);
            let points: Vec<_> = std::iter::once(DVec2::ZERO).chain((0..=12).map(rim)).collect();
            let triangles: Vec<_> = (1..=12).map(|k| [0, k, k + 1]).collect();
            Boundary::of(&triangles, points.len()).meetings(&points)
        };
        assert!(fan(0.9).is_empty());
        assert!(fan(1.2).contains(&0));
    }
}
