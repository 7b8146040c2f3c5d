"""In the place of dyncal.models in a wheel that was built without Ceres."""

raise ImportError(
    "dyncal.models: this wheel of dyncal was built without Ceres; build one with "
    "--config-settings=cmake.define.DYNCAL_MODELS=ON where Ceres is installed "
    "(Debian: libceres-dev)"
)
