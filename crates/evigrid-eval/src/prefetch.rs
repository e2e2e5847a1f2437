use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::Scope;

use evigrid_core::{Frame, Pose};
use evigrid_replay::{ReplayError, Sequence};

use crate::Clock;

/// Frames that may wait to be mapped: memory stays bounded however long the recording is.
const FRAMES_AHEAD: usize = 2;

/// Reads frames on a thread of its own while earlier ones are mapped. Each comes with the milliseconds that
/// reading took. Reading ends with the first error, or when the receiver is dropped.
pub(crate) fn read_ahead<'scope>(
    scope: &'scope Scope<'scope, '_>,
    sequence: &'scope dyn Sequence,
    frames: &'scope [usize],
    map_from_world: Pose,
    clock: &'scope dyn Clock,
) -> Receiver<Result<(Frame, f64), ReplayError>> {
    let (sender, receiver) = sync_channel(FRAMES_AHEAD);
    scope.spawn(move || {
        for &index in frames {
            let start = clock.now_ms();
            let frame = sequence.frame(index, &map_from_world).map(|f| (f, clock.now_ms() - start));
            let failed = frame.is_err();
            if sender.send(frame).is_err() || failed {
                return;
            }
        }
    });
    receiver
}
