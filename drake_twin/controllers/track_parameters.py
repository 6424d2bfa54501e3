"""The parameters of ``gz_sim/Tracks``: belts and tracks, and the vehicle that some of them drive."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from math import inf, isfinite

from drake_twin.controllers.drive_controller import check_covariances
from drake_twin.controllers.speed_limits import LimitsX, LimitsZ, SpeedLimits
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError

_ZEROS = (0.0,) * 6


@dataclass(frozen=True, kw_only=True)
class TrackParameters:
    """A belt or track, named after the elements of ``gz-sim-track-controller-system``.

    Attributes:
        link: The link whose surface moves.
        axis: The axis in the link's frame that the surface turns about: at its top a positive speed along y is along x.
        max_command_age: The time after which a command expires and the surface stops (s).
        odometry_publish_frequency: The rate of the odometry (Hz); 0 for each update.
        limits: The limits of the speed.
    """

    link: str
    axis: tuple[float, ...] = (0.0, 1.0, 0.0)
    max_command_age: float = field(default=inf, metadata={"lower": 0.0})
    odometry_publish_frequency: float = field(default=50.0, metadata={"lower": 0.0})
    limits: SpeedLimits = field(default_factory=SpeedLimits)

    def __post_init__(self) -> None:
        if len(self.axis) != 3 or not any(self.axis) or not all(map(isfinite, self.axis)):
            raise ParameterError(f"axis is {list(self.axis)}, and has to be three numbers that are not all 0", "axis")


@dataclass(frozen=True, kw_only=True)
class TracksParameters:
    """Parameters of ``gz_sim/Tracks``, those of the vehicle named after ``gz-sim-tracked-vehicle-system``.

    Attributes:
        tracks: The belts and tracks, each under a name of its topics.
        left_tracks: Those on the vehicle's left side; empty without a vehicle.
        right_tracks: Those on its right side.
        tracks_separation: The distance between the two sides (m).
        steering_efficiency: The yaw rate ÷ that of a vehicle on wheels without slip; a topic may change it.
        tf_frame_prefix_enable: Whether the frames' names get a prefix.
        tf_frame_prefix: The prefix; empty for the namespace.
        odom_frame_id: The frame of the vehicle's odometry.
        base_frame_id: The frame of the base.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        enable_odom_tf: Whether the odometry's transform is published.
        linear: The limits of the forward velocity.
        angular: The limits of the velocity about z.
        use_stamped_vel: Whether commands are of type ``TwistStamped``.
    """

    tracks: Mapping[str, TrackParameters] = field(default_factory=dict)
    left_tracks: tuple[str, ...] = ()
    right_tracks: tuple[str, ...] = ()
    tracks_separation: float = field(default=1.0, metadata={"above": 0.0})
    steering_efficiency: float = field(default=0.5, metadata={"above": 0.0})
    tf_frame_prefix_enable: bool = False
    tf_frame_prefix: str = ""
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    pose_covariance_diagonal: tuple[float, ...] = _ZEROS
    twist_covariance_diagonal: tuple[float, ...] = _ZEROS
    enable_odom_tf: bool = True
    linear: LimitsX = field(default_factory=LimitsX)
    angular: LimitsZ = field(default_factory=LimitsZ)
    use_stamped_vel: bool = True

    def __post_init__(self) -> None:
        if not self.tracks:
            raise ParameterError("tracks is empty", "tracks")
        links = [track.link for track in self.tracks.values()]
        for name, track in self.tracks.items():
            if links.count(track.link) > 1:
                raise ParameterError(f"several tracks have the link {track.link!r}", "tracks", name, "link")
        for side in ("left_tracks", "right_tracks"):
            for name in getattr(self, side):
                if name not in self.tracks:
                    raise ParameterError(f"{side} has {name!r}, which is not one of the tracks", side)
        if bool(self.left_tracks) != bool(self.right_tracks):
            empty = "right_tracks" if self.left_tracks else "left_tracks"
            raise ParameterError(f"{empty} is empty", empty)
        check_covariances(self)

    @property
    def is_vehicle(self) -> bool:
        """Whether some of the tracks drive a vehicle."""
        return bool(self.left_tracks)

    def sides(self) -> Iterator[int | None]:
        """Yield for each track its side of the vehicle: 0 for left, 1 for right, None for neither."""
        for name in self.tracks:
            yield 0 if name in self.left_tracks else 1 if name in self.right_tracks else None
