# SPDX-FileCopyrightText: 2026 The msss_graphslam authors
# SPDX-License-Identifier: Apache-2.0
"""When the next beam is to be asked for: heads answer a request with one beam or with two."""

__all__ = ["Requests"]


class Requests:
    """Counts beams against requests, so that the head is never idle and never floods the line.

    How many beams a request brings is seen from the first one, after which the head is listened to
    for a while. A head that sends two is asked again after the first of them.
    """

    def __init__(self) -> None:
        self.a_request_brings = 1
        self.listening = False
        self._owed = 0
        self._answers = 0

    def find_out(self) -> None:
        """Begin anew, with a request after which the head is listened to."""
        self._begin(1, listening=True)

    def go_on(self) -> None:
        """Begin anew with a head that does as before, unless too much was expected of it."""
        if self.listening or self.a_request_brings > 1:
            self.find_out()
        else:
            self._begin(1, listening=False)

    def asked(self) -> None:
        """Take note that a request was sent."""
        self._owed += self.a_request_brings

    def answered(self) -> bool:
        """Take note of a beam; return whether to ask for the next."""
        self._owed = max(self._owed - 1, 0)
        self._answers += 1
        return not self.listening and self._owed < self.a_request_brings

    def heard_out(self) -> bool:
        """Return whether a time of listening is over now, which is no silence of the head."""
        if not (self.listening and self._answers):
            return False
        self._begin(min(self._answers, 2), listening=False)
        return True

    def _begin(self, a_request_brings: int, listening: bool) -> None:
        self.a_request_brings, self.listening = a_request_brings, listening
        self._owed = self._answers = 0
