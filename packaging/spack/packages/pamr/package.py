# SPDX-License-Identifier: GPL-3.0-or-later
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Pamr(CMakePackage):
    """Parallel adaptive refinement of tetrahedral meshes: library and tools."""

    # `spack dev-build pamr@main` in a checkout takes the sources from there.
    version("main")
    version("0.3.0")
    version("0.2.0")
    license("GPL-3.0-or-later")

    variant("dsmc", default=True, description="the solver for rarefied gas")
    variant("poisson_boltzmann", default=False, description="the solver for charged bodies, on PETSc")
    variant("python", default=True, description="the Python package")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("mpi")
    depends_on("hdf5+mpi")
    depends_on("scotch@7:+mpi+int64~shared+compression")  # static: PETSc may load one with 32-bit integers
    depends_on("zlib-api")
    depends_on("bzip2")
    depends_on("xz")
    depends_on("cgal@5.5:6.0")
    depends_on("cli11")
    depends_on("fmt")
    depends_on("pugixml")
    depends_on("tomlplusplus")
    depends_on("nlohmann-json")
    depends_on("random123", when="+dsmc")
    depends_on("petsc~complex", when="+poisson_boltzmann")
    depends_on("pkgconfig", type="build", when="+poisson_boltzmann")
    with when("+python"):
        extends("python")
        depends_on("py-numpy", type=("build", "run"))
        depends_on("py-mpi4py", type=("build", "run"))
        depends_on("py-pybind11@2.10:", type="build")

    def cmake_args(self):
        return [
            self.define("PAMR_TESTS", False),
            self.define("PAMR_BENCH", False),
            self.define("PAMR_BATCHES", True),
            self.define("PAMR_SURFACE_MESH", False),  # Spack has no OpenMesh
            self.define("PTScotch_ROOT", self.spec["scotch"].prefix),
            self.define("ParallelHDF5_ROOT", self.spec["hdf5"].prefix),
            self.define_from_variant("PAMR_DSMC", "dsmc"),
            self.define_from_variant("PAMR_POISSON_BOLTZMANN", "poisson_boltzmann"),
            self.define_from_variant("PAMR_PYTHON_MODULE", "python"),
        ]
