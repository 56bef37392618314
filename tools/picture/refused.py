# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of everything that a user can mend."""


class Refused(Exception):
    """Bad usage or bad input: says what was expected and what was found."""
