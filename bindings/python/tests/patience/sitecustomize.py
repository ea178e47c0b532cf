# SPDX-License-Identifier: MIT
"""Patience with a loaded machine, for the programs that tests start.

Every Python that has this folder in PYTHONPATH imports this module first. By default a client
disarms where it has heard nothing for 300 ms, and stops where the program did not repeat a
command for 250 ms, as it must on a robot; a machine that does not run a test for so long is no
failure. What the defaults promise is tested in virtual time.
"""

try:
    from roburoc4 import _native
except ImportError:  # a Python without the package
    pass
else:
    _new_config = _native.new_config

    def _patient() -> "_native.Config":
        config = _new_config()
        for name in ("fresh_ms", "lease_ms"):
            getattr(_native, f"roburoc4_config_{name}_set")(config, 1000)  # the maximum
        return config

    _native.new_config = _patient
