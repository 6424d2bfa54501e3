"""Which publishers and subscriptions of nodes hear each other, and what they are told of their quality of service.

A subscription hears a publisher if it requests no more than is offered. Deadlines and leases of liveliness are spans of
simulation time: a deadline begins with the first message, the lease of a publisher that asserts itself when it is made.
"""

from collections.abc import Callable, Sequence
from typing import Any

from drake_twin.nodes.graph_items import Publication, Reception
from drake_twin.twin.endpoints import Endpoint

Item = Publication | Reception
_ENDLESS = 2**62  # ns: what is longer never passes


class QosEvents:
    """Pairs what nodes publish with what they subscribe to.

    Args:
        now: Returns the simulation time (ns).
        post: Lets something happen after some ns.
    """

    def __init__(self, now: Callable[[], int], post: Callable[[Callable[[], None], int], None]):
        from drake_twin.nodes.rclpy import qos_compatibility  # it needs the graph, which needs this

        self._now, self._post = now, post
        self._mismatch, self._profile_of = qos_compatibility.mismatch, qos_compatibility.profile_of
        self._is_manual, self._seen = qos_compatibility.is_manual, qos_compatibility.as_seen
        self._told_as = qos_compatibility.rmw_qos_policy_kind_t

    def pair(self, publication: Publication, reception: Reception) -> None:
        """Let a subscription hear a publisher if it may."""
        if publication.type != reception.type or reception in publication.matched:
            return
        is_open = None in (publication.profile, reception.profile)  # what the twin has for an action's messages
        kind = None if is_open else self._mismatch(publication.profile, reception.profile)
        if kind is not None:
            self.refused(publication, kind)
            self.refused(reception, kind)
            return
        publication.matched.append(reception)
        reception.matched.append(publication)
        self.counted(publication, 1)
        self.counted(reception, 1)
        _tell(reception, "liveliness", **{"not_alive_count" if publication.is_lost else "alive_count": 1})

    def offered(self, publications: Sequence[Publication]) -> dict[str, Any]:
        """Return the quality of service of a topic that nodes publish, as an `Endpoint` has it: the best of theirs."""
        return self._common(publications, min, any)

    def requested(self, receptions: Sequence[Reception]) -> dict[str, Any]:
        """Return that of a topic that nodes subscribe to: what suits all of them."""
        return self._common(receptions, max, all)

    def _common(self, items: Sequence[Item], best: Callable[..., int], which: Callable[..., bool]) -> dict[str, Any]:
        is_publisher = best is min
        given = [item.profile for item in items if item.profile is not None]
        profiles = [self._seen(each, is_publisher=is_publisher) for each in given]
        if not profiles:
            return {}
        spans = {
            "lifespan": max(each.lifespan.nanoseconds for each in profiles),
            "deadline": best(each.deadline.nanoseconds for each in profiles),
            "lease": best(each.liveliness_lease_duration.nanoseconds for each in profiles),
        }
        depths = [each.depth for each in profiles]
        return {
            "depth": max(depths),
            "keeps_all": 0 in depths,
            "is_manual": which(map(self._is_manual, profiles)),
            **{name: span / 1e9 for name, span in spans.items() if span < _ENDLESS},
        }

    def commands(self, publication: Publication, endpoint: Endpoint) -> bool:
        """Return whether a topic of the twin hears a publisher."""
        kind = self._mismatch(publication.profile, self._profile_of(endpoint))
        self.counted(publication, 1) if kind is None else self.refused(publication, kind)
        return kind is None

    def hears(self, reception: Reception, endpoint: Endpoint) -> bool:
        """Return whether a subscription hears a topic of the twin."""
        kind = self._mismatch(self._profile_of(endpoint), reception.profile)
        self.counted(reception, 1) if kind is None else self.refused(reception, kind)
        return kind is None

    def part(self, item: Item) -> None:
        """Take back a publisher or a subscription."""
        for other in item.matched:
            other.matched.remove(item)
            self.counted(other, -1)
            if isinstance(other, Reception) and isinstance(item, Publication):
                _tell(other, "liveliness", **{"not_alive_count" if item.is_lost else "alive_count": -1})
        item.matched.clear()
        item.is_over = True

    def refused(self, item: Item, kind: int) -> None:
        """Tell of another one that offers less, or requests more."""
        _tell(item, "incompatible_qos", total_count=1, last_policy_kind=self._told_as(kind))

    def counted(self, item: Item, change: int) -> None:
        """Tell of another one that has come or gone."""
        _tell(item, "matched", total_count=max(0, change), current_count=change)

    def passed(self, item: Item) -> None:
        """Take note of a message."""
        deadline = item.profile.deadline.nanoseconds
        is_first, item.last = item.last is None, self._now()
        if is_first and 0 < deadline < _ENDLESS and "deadline" in item.listeners:
            self._post(lambda: self._look(item, deadline), deadline)
        if isinstance(item, Publication):
            self.asserted(item)

    def asserted(self, publication: Publication) -> None:
        """Take note of a publisher that says that it is alive."""
        profile, lease = publication.profile, publication.profile.liveliness_lease_duration.nanoseconds
        if not self._is_manual(profile) or not 0 < lease < _ENDLESS:
            return
        is_first, publication.asserted = publication.asserted is None, self._now()
        if publication.is_lost:
            publication.is_lost = False
            for reception in publication.matched:
                _tell(reception, "liveliness", alive_count=1, not_alive_count=-1)
            is_first = True
        if is_first:
            self._post(lambda: self._look_alive(publication, lease), lease)

    def _look(self, item: Item, deadline: int) -> None:
        assert item.last is not None
        if item.is_over:
            return
        rest = item.last + deadline - self._now()
        if rest <= 0:
            item.last += deadline
            _tell(item, "deadline", total_count=1)
            rest = item.last + deadline - self._now()
        self._post(lambda: self._look(item, deadline), max(rest, 0))

    def _look_alive(self, publication: Publication, lease: int) -> None:
        assert publication.asserted is not None
        rest = publication.asserted + lease - self._now()
        if publication.is_over:
            return
        if rest > 0:
            self._post(lambda: self._look_alive(publication, lease), rest)
            return
        publication.is_lost = True
        _tell(publication, "liveliness", total_count=1)
        for reception in publication.matched:
            _tell(reception, "liveliness", alive_count=-1, not_alive_count=1)


def _tell(item: Item, event: str, **changes: Any) -> None:
    listener = item.listeners.get(event)
    if listener is not None:
        listener(changes)
