use super::*;

const NS: f32 = 1.0;

fn ran(stages: &[Stage]) -> StageSet {
    let mut set = StageSet::default();
    stages.iter().for_each(|stage| set.set(*stage, true));
    set
}

fn ticks(of_stages: &[u64]) -> [u64; QUERIES] {
    // What an earlier frame left behind the last stage.
    let mut all = [7; QUERIES];
    all[..of_stages.len()].copy_from_slice(of_stages);
    all
}

#[test]
fn stages_get_their_own_ticks() {
    let ran = ran(&[Stage::Deform, Stage::Gather, Stage::Resolve]);
    let at = |all| evaluate(&ticks(all), ran, 2.0, 5).unwrap();
    let ns = |timings: FrameTimings| timings.stages.map(|time| Some(time?.as_nanos()));
    let timings = at(&[100, 104, 130, 135, 240, 240, 241]);
    assert_eq!(ns(timings), [Some(60), None, None, Some(220), None, None, Some(2)]);
    assert_eq!((timings.total.as_nanos(), timings.frame, timings.clock), (282, 5, Clock::Gpu));
    assert_eq!(timings.stage(Stage::Gather), Some(Duration::from_nanos(220)));
    let without_start = at(&[0, 104, 130, 135, 240, 240, 241]);
    assert_eq!(ns(without_start), [Some(52), None, None, Some(220), None, None, Some(2)]);
    let overlapping = at(&[100, 104, 150, 120, 130, 140, 160]);
    assert_eq!(ns(overlapping), [Some(100), None, None, Some(0), None, None, Some(20)]);
    assert_eq!(overlapping.total.as_nanos(), 120);
}

#[test]
fn timestamps_that_cannot_be_are_no_times() {
    let both = ran(&[Stage::Gather, Stage::Scatter]);
    assert!(evaluate(&ticks(&[5, 6, 7, 7, 8]), both, NS, 1).is_some());
    for broken in
        [[0; 5], [5, 6, 0, 0, 0], [0, 0, 7, 7, 8], [5, 6, 0, 7, 8], [5, 6, 7, 7, 0], [9, 9, 7, 7, 8]]
    {
        assert_eq!(evaluate(&ticks(&broken), both, NS, 1), None, "{broken:?}");
    }
}

#[test]
fn parts_of_a_frame_are_joined_and_old_frames_dropped() {
    let part = |frame, stage: Stage, length: u64| {
        evaluate(&ticks(&[10, 10, 10 + length]), ran(&[stage]), NS, frame).unwrap()
    };
    let newest = Newest::default();
    assert_eq!(newest.get(), None);
    newest.deliver(part(2, Stage::Gather, 30));
    newest.deliver(part(2, Stage::Scatter, 4));
    newest.deliver(part(1, Stage::Deform, 500));
    let joined = newest.get().unwrap();
    let ns = |stage| joined.stage(stage).map(|time| time.as_nanos());
    assert_eq!(Stage::ALL.map(ns), [None, None, None, Some(30), None, Some(4), None]);
    assert_eq!((joined.frame, joined.total.as_nanos()), (2, 34));
    newest.deliver(part(3, Stage::Deform, 1));
    assert_eq!(newest.get(), Some(part(3, Stage::Deform, 1)));
}

#[test]
fn wall_times_of_parts_overlap() {
    let part = |ms| FrameTimings { frame: 1, total: Duration::from_millis(ms), ..Default::default() };
    let newest = Newest::default();
    newest.deliver(part(20));
    newest.deliver(part(15));
    assert_eq!(newest.get(), Some(part(20)));
}
