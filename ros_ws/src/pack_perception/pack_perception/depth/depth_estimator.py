"""Poses of all objects from depth images, and from simulated physics between them.

At first a look finds out what is where: which of the described objects, or, where nobody described them, what
they are, and what hangs on the cup. From then on each image corrects what physics predicts, as markers do:
the surface of each object is fitted to the points that are near where it is expected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from pack_core.camera import PinholeCamera
from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame
from pack_core.packing.free_space import is_packed
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.rotations import Array, Pose, conjugate, rotate
from pack_perception.depth.extrinsics import Extrinsics
from pack_perception.depth.held_fit import held_shape
from pack_perception.depth.look import (
    BELOW_HELD,
    SeenShape,
    ceiling_below,
    look_at,
    off_arm,
    off_container,
    off_tool,
)
from pack_perception.depth.second_look import (
    KnownObject,
    SecondLooks,
    is_seen_through,
    with_shapes,
)
from pack_perception.depth.sight_lines import SightLines
from pack_perception.depth.surface_fit import (
    ConvexSurface,
    assigned,
    fit_surface,
    still_there,
    which_is_where,
)
from pack_perception.depth.tool_shape import ToolShape
from pack_perception.mocap.guided_cell import GuidedCell
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.physics_estimator import Correction
from pack_perception.perception_config import Objects, PerceptionConfig

COARSE = 8
"""Every many pixels each way one tells whether a camera is covered."""


class DepthEstimator(HandOverEstimator):
    """A `HandOverEstimator` that depth images correct instead of markers.

    Args:
        scene: container, held object and, where they are described, the objects in the container.
        cell: the cell's physical facts.
        config: gains and limits, and parameters of looks and fits.
        cameras: where the cameras hang, as a calibration has found it; None: as the cell describes it.

    Attributes:
        deviations: how sure looks were of the objects that they saw, by name.
        looked: when the images were exposed that the last look was made at [s]; nan before the first.
        hindrance: what kept from a look at the newest images, in words; empty if nothing did.
    """

    def __init__(
        self, scene: Scene, cell: PackingCell, config: PerceptionConfig,
        cameras: Sequence[PinholeCamera] | None = None,
    ) -> None:  # fmt: skip
        self._depth = config.depth
        self._extrinsics = Extrinsics(
            cameras or cell.depth.cameras(), is_calibrated=cameras is not None, container=scene.container,
            config=config.depth,
        )  # fmt: skip
        self.deviations: dict[str, SeenDeviations] = {}
        self.looked, self.hindrance = float("nan"), ""
        self._needs_look, self._numbered, self._tool = True, 0, ToolShape.of(cell)
        self._looks = SecondLooks(config.depth.again)
        is_known = self._depth.objects is Objects.DESCRIBED
        super().__init__(scene if is_known else scene.model_copy(update={"objects": []}), cell, config)

    @property
    def misplaced(self) -> Mapping[int, str]:
        """How far off each camera is that hangs elsewhere than was told, in words, by its place in the list.

        Nothing is looked for while there are any.
        """
        return self._extrinsics.misplaced

    @property
    def knows_objects(self) -> bool:
        """Whether it is known which objects there are: from a description, or after a look."""
        return self._depth.objects is Objects.DESCRIBED or not self._needs_look

    @property
    def needs_look(self) -> bool:
        """Whether the next images are looked at, as objects have no pose yet."""
        return self._needs_look

    def see(self, frame: DepthFrame) -> Correction:
        """Correct the estimate by images; before all objects are known, look for them.

        The errors are those at the time of exposure; they are corrected then and in all poses since.
        """
        if self.is_ahead(frame) or not self._history.covers(frame.time):
            return Correction(is_unused=True)
        if self._needs_look:
            self.hindrance = self._look(frame)
        # with other objects the history begins anew, so that this frame has nothing more to correct
        if not self._history.covers(frame.time):
            return Correction()
        correction = self._track(frame)
        is_unknown = self._depth.objects is Objects.UNKNOWN
        if is_unknown and self._looks.is_worth_it(frame.time, self._places()):
            self._look_again(frame)
        return correction

    def change_scene(self, scene: Scene) -> None:
        """Go on with other objects, as `HandOverEstimator` does; one that is handed over is where announced.

        The cameras see the hand-over place at the edge of a picture at most: how the object hangs is seen
        once it is over the container. Where nobody describes what is in there, what was seen of it stays, and
        the object before joins it if it was let go there; only that it is empty is believed.
        """
        last = self._scene.new_object.name
        is_next = scene.is_handed_over and scene.new_object.name != last
        if self._depth.objects is Objects.UNKNOWN and is_next and scene.objects:
            state = None if self._joints is None else self.state(self.time).objects.get(last)
            keep = state is not None and is_packed(self._scene, state.X_WO)
            scene = self._scene.with_next(scene.new_object, keep=keep).description()
        if scene.container != self._scene.container:
            self._extrinsics.expect(scene.container)
        self._measures_held &= not scene.is_handed_over
        super().change_scene(scene.model_copy(update={"container": self._extrinsics.container}))
        self._expect_announced()

    def take_hold(self) -> Pose | None:
        """The pump has gripped the new object; what nobody described in the container is looked for anew.

        The arm is beside the container now, and what was packed before counts as unknown like all the rest.

        Returns:
            X_TN, how it hangs; None if it was never seen, or hangs already.
        """
        X_TN = super().take_hold()
        if X_TN is not None and self._depth.objects is Objects.UNKNOWN:
            self._needs_look = True
        return X_TN

    def _start_over(self) -> None:
        super()._start_over()
        self._needs_look = True
        self._looks.start_over()
        # one that is handed over is announced with its sizes
        self._measures_held = self._depth.objects is Objects.UNKNOWN and not self._scene.is_handed_over
        self._expect_announced()

    def _expect_announced(self) -> None:
        """Take a new object that is handed over, and was not seen, to stand where it is announced."""
        announced, row = self._scene.new_object.pose, len(self._markers.names) - 1
        self._is_announced = announced is not None and not self._is_known[row]
        if announced is None or not self._is_announced:
            return
        X_WN = announced.to_pose()
        self._physics.correct(np.array([row]), np.concatenate([X_WN.p, X_WN.q])[None], np.zeros((1, 6)))
        self._seen[row] = self._started
        if self._joints is not None:
            self._note(self._joints)

    def _use(self, physics: GuidedCell) -> None:
        super()._use(physics)
        self._surfaces = [ConvexSurface.of(self._scene.model_of(name)) for name in self._markers.names]

    def _look(self, frame: DepthFrame) -> str:
        """Find the objects that have no pose so far, and what hangs on the cup if nobody measured it.

        Returns:
            What keeps from it, in words; empty where nothing does.
        """
        X_WN = None if self._measures_held else Pose(*np.split(self._poses(frame.time)[-1], [3]))
        scene = self._scene
        rim = scene.container.height
        if X_WN is not None and ceiling_below(scene.new_object, X_WN, scene.container) < rim:
            return "what hangs on the cup is among the objects in the container"
        if not len(self._extrinsics.points(frame, COARSE)):
            return "the cameras measure nothing: are they covered?"
        self._extrinsics.register(frame)
        if self.misplaced:
            return "a camera hangs elsewhere than described"
        points = self._extrinsics.points(frame)
        surely: dict[str, SeenDeviations] = {}
        if X_WN is None:
            X_WT = self._physics.cup_pose(self._history.at(frame.time))
            beside = off_tool(points, X_WT, self._tool)
            held = held_shape(beside, self._extrinsics.cameras, X_WT, scene.new_object, self._depth)
            if held is None:
                return f"'{scene.new_object.name}' on the cup is not seen all around by the cameras"
            scene = scene.model_copy(update={"new_object": held.item}).gripped(held.X_TN)
            X_WN, surely = X_WT @ held.X_TN, {held.item.name: held.deviations}
            self._measures_held = False
        points = points[points[:, 2] < ceiling_below(scene.new_object, X_WN, scene.container)]
        self.looked = frame.time
        if self._depth.objects is Objects.UNKNOWN:
            where = self._look_for_all(points, frame, scene, surely)
        else:
            where = self._look_for_described(points, frame)
        self._place(where, frame.time)
        self._needs_look = not np.all(self._is_known[: len(self._scene.objects)])
        self._looks.note(frame.time, self._places())
        return ""

    def _place(self, where: Mapping[str, Pose], time: float) -> None:
        """Put objects that had no pose so far where they were seen, X_WO by name."""
        names = self._markers.names
        rows = np.array([i for i, n in enumerate(names) if n in where and not self._is_known[i]], dtype=int)
        seen = np.zeros((len(names), 7))
        for i in rows:
            seen[i] = [*where[names[i]].p, *where[names[i]].q]
        apart = self._physics.pushed_apart(rows, seen[rows])
        self._correct_free(rows, apart, self._physics.poses()[rows], time)
        self._seen[rows] = self._fitted[rows] = time

    def _places(self) -> dict[str, Array]:
        """Positions `(3,)` [m] of the objects in the container, by name."""
        return dict(zip(self._physics.free, self._physics.poses()[:, :3], strict=True))

    def _look_again(self, frame: DepthFrame) -> None:
        """Take up what two looks in a row have seen: objects that are new, and shapes that are surer."""
        poses = self._poses(frame.time)
        free, surely = self._physics.free, {name: self.deviations.get(name) for name in self._scene.names}
        sight, known = self._sight(frame), list[KnownObject]()
        for name, pose in zip(free, poses[: len(free)], strict=True):
            item, X_WO = self._scene.model_of(name), Pose(*np.split(pose, [3]))
            is_lost = is_seen_through(item, X_WO, sight)
            known.append(KnownObject(item, X_WO, surely.get(name), is_lost=is_lost))
        X_WT, rim = self._physics.cup_pose(self._history.at(frame.time)), self._scene.rim
        points = off_arm(self._extrinsics.points(frame), X_WT, rim)
        if self._held >= 0:
            p_N = rotate(conjugate(poses[-1, 3:]), points - poses[-1, :3])
            points = points[self._surfaces[-1].distances(p_N)[0] > BELOW_HELD]
        fits = self._looks.believed(self._seen_in(points, sight, self._looks.sure(known)), known)
        if fits:
            names = self._markers.names
            # poses of those that are known are those of other shapes
            self._seen[[names.index(name) for name in fits if name in names]] = -np.inf
            self.change_scene(with_shapes(self._scene, fits))
            self.deviations = {**self.deviations, **{name: fit.deviations for name, fit in fits.items()}}
            self._place({name: fit.X_WO for name, fit in fits.items()}, frame.time)
            self.looked = frame.time
        self._looks.note(frame.time, self._places())

    def _sight(self, frame: DepthFrame) -> SightLines:
        return SightLines(self._extrinsics.cameras, frame.images, self._depth.look.behind)

    def _seen_in(
        self, points: Array, sight: SightLines, known: Sequence[shapely.Polygon] = ()
    ) -> list[SeenShape]:
        """What points `(n, 3)` [m] are of, as cameras saw them, but for what has these outlines."""
        found = look_at(points, sight, self._extrinsics.container, self._depth.look, self._numbered, known)
        self._numbered += len(found)
        return found

    def _look_for_all(
        self, points: Array, frame: DepthFrame, scene: Scene, surely: Mapping[str, SeenDeviations]
    ) -> dict[str, Pose]:
        """Take up a scene with what is in the container, remembered or new; X_WO of what is new, by name.

        Args:
            points: what was measured below the held object `(n, 3)` [m].
            frame: the frame that they come from.
            scene: with what hangs on the cup.
            surely: how sure that is, where it was measured now.
        """
        there, rest = self._remembered(points, frame.time)
        found = self._seen_in(rest, self._sight(frame))
        objects = [*there, *(fit.item for fit in found)]
        known = {**self.deviations, **{fit.item.name: fit.deviations for fit in found}, **surely}
        self.change_scene(scene.model_copy(update={"objects": objects}))
        names = {item.name for item in (*objects, scene.new_object)}
        self.deviations = {name: item for name, item in known.items() if name in names}
        return {fit.item.name: fit.X_WO for fit in found}

    def _look_for_described(self, points: Array, frame: DepthFrame) -> dict[str, Pose]:
        """X_WO of the described objects that are among points `(n, 3)` [m] of a frame, by name."""
        found = self._seen_in(points, self._sight(frame))
        if self._extrinsics.container != self._scene.container:
            self.change_scene(self._scene)
        return which_is_where(found, self._scene.objects, self._depth.fit)

    def _remembered(self, points: Array, time: float) -> tuple[list[ObjectModel], Array]:
        """The objects that are known already and still there, and the points `(n, 3)` that are not of them.

        Two boxes of one height side by side look like one; who has put them there knows better.
        """
        known = np.flatnonzero(self._is_known[: len(self._scene.objects)])
        surfaces = [self._surfaces[i] for i in known]
        is_there, rest = still_there(points, surfaces, self._poses(time)[known], self._depth.fit.reach)
        return [self._scene.objects[i] for i in known[is_there]], rest

    def _poses(self, time: float) -> Array:
        """X_WO `(n, 7)` of all objects at an earlier time, the new one last."""
        earlier = self._history.at(time)
        poses = self._physics.poses(earlier)
        if self._held < 0:
            return poses
        X_WN = self._physics.cup_pose(earlier) @ self._grip.X_TN
        return np.vstack([poses, np.concatenate([X_WN.p, X_WN.q])])

    def _track(self, frame: DepthFrame) -> Correction:
        """Fit all objects that are known to the points near them."""
        expected, config = self._poses(frame.time), self._depth.fit
        known = self._is_known.copy()
        known[self._held] |= self._held >= 0
        rows = np.flatnonzero(known)
        points = self._extrinsics.points(frame, self._depth.every)
        points = off_container(points, self._scene.container, self._depth.look.on_wall)
        points = off_tool(points, self._physics.cup_pose(self._history.at(frame.time)), self._tool)
        parts = assigned(points, [self._surfaces[i] for i in rows], expected[rows], config.reach)
        seen, fitted = expected.copy(), []
        for i, part in zip(rows, parts, strict=True):
            if len(part) >= config.few:
                seen[i] = fit_surface(self._surfaces[i], part, expected[i], config)
                fitted.append(i)
        done = np.array(fitted, dtype=int)
        self._take(done, seen, self._history.at(frame.time), frame.time)
        self._fitted[done] = frame.time
        # an announced object that nobody expects to see is no sign of blind cameras
        if self._is_announced and not np.isfinite(self._fitted[-1]):
            self._seen[-1] = frame.time
        return Correction(tuple(self._markers.names[i] for i in done))
