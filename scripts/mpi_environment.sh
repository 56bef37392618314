# SPDX-License-Identifier: GPL-3.0-or-later
# To be sourced: has Open MPI run anywhere. Variables that are set already stay as they are; other MPIs ignore them.

if [ "$(id -u)" = 0 ]; then # root, as in most containers
  export OMPI_ALLOW_RUN_AS_ROOT="${OMPI_ALLOW_RUN_AS_ROOT:-1}"
  export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="${OMPI_ALLOW_RUN_AS_ROOT_CONFIRM:-1}"
fi
# More ranks than cores, with waiting ranks giving up their core. Open MPI 5 starts them by PRRTE, which has own variables.
export OMPI_MCA_rmaps_base_oversubscribe="${OMPI_MCA_rmaps_base_oversubscribe:-1}"
export PRTE_MCA_rmaps_default_mapping_policy="${PRTE_MCA_rmaps_default_mapping_policy:-:oversubscribe}"
export OMPI_MCA_mpi_yield_when_idle="${OMPI_MCA_mpi_yield_when_idle:-1}"
# No warning about cross-memory attach, which containers forbid.
export OMPI_MCA_btl_vader_single_copy_mechanism="${OMPI_MCA_btl_vader_single_copy_mechanism:-none}"
# Nor one of Open MPI 5, for each pair of ranks, where an interface has addresses of IPv6.
export OMPI_MCA_btl_tcp_disable_family="${OMPI_MCA_btl_tcp_disable_family:-6}"
# No search for fast interconnects where there are none: two of the libraries that Open MPI would load for them measure
# the processor's clock for 0.1 s each, which is more than half of the time in which a small job starts. Nor a look at the
# devices of the bus, of which each process of a virtual machine asks the host.
if [ -z "$(ls -A /sys/class/infiniband /sys/class/cxi 2>/dev/null)" ]; then
  export OMPI_MCA_mtl="${OMPI_MCA_mtl:-^psm,psm2,ofi}"
  export HWLOC_COMPONENTS="${HWLOC_COMPONENTS:--gl,-pci,-linux:pci}"
  # Nor the libraries of X, OpenCL and XML, which each process would load and none would use.
  export HWLOC_PLUGINS_PATH="${HWLOC_PLUGINS_PATH:-/nonexistent}"
fi
# No question to an X server for graphics cards: one that ends meanwhile takes the job with it.
export HWLOC_COMPONENTS="${HWLOC_COMPONENTS:--gl}"
