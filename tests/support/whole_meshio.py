# SPDX-License-Identifier: GPL-3.0-or-later
"""meshio, which reads the `.vtu` of PAMR and VTK with every Python: `from whole_meshio import meshio`.

Up to 5.3.5 it makes base64 of each array behind the XML, joins these, and decodes what begins at an array up to the end of
all: the decoder has to end at the first padding. Python does not any more (python/cpython, issue 145264, CVE-2026-3446).
"""
import base64
import binascii
import types

import meshio
import meshio.vtu._vtu as reader


def ends_at_padding():
    try:
        return base64.b64decode("AA==AAAA") == b"\0"
    except binascii.Error:
        return False


def decode_to_padding(text):
    padding = text.find("=")  # fills four characters
    return base64.b64decode(text if padding < 0 else text[:(padding // 4 + 1) * 4])


if not ends_at_padding():
    reader.base64 = types.SimpleNamespace(b64decode=decode_to_padding, b64encode=base64.b64encode)
