// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi_counts.hpp"

#include <mpi.h>

#include <map>

#include "pamr/base/timer.hpp"

namespace {

struct Counts : pamr::bench::MpiCounts {
  int depth = 0;                                 ///< of calls of MPI within calls of MPI, which do not count
  std::map<MPI_Request, std::int64_t> prepared;  ///< bytes of messages that are sent again and again
};
Counts own;

template <class Call>
int timed(const Call& call) {
  if (own.depth++ > 0) {
    const int code = call();
    --own.depth;
    return code;
  }
  const double start = pamr::cpu_seconds();
  const int code = call();
  own.cpu += pamr::cpu_seconds() - start;
  --own.depth;
  return code;
}

template <class Call>
int together(const Call& call) {
  if (own.depth == 0) ++own.reductions;
  return timed(call);
}

std::int64_t size_of(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return std::int64_t{count} * size;
}

template <class Call>
int sends(int count, MPI_Datatype type, const Call& call) {
  if (own.depth == 0) {
    ++own.messages;
    own.bytes += size_of(count, type);
  }
  return timed(call);
}

void start_prepared(MPI_Request request) {
  const auto found = own.prepared.find(request);
  if (found == own.prepared.end()) return;  // a receive
  ++own.messages;
  own.bytes += found->second;
}

}  // namespace

extern "C" {
int MPI_Send(const void* b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c) {
  return sends(n, t, [&] { return PMPI_Send(b, n, t, to, tag, c); });
}
int MPI_Isend(const void* b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request* r) {
  return sends(n, t, [&] { return PMPI_Isend(b, n, t, to, tag, c, r); });
}
int MPI_Issend(const void* b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request* r) {
  return sends(n, t, [&] { return PMPI_Issend(b, n, t, to, tag, c, r); });
}
int MPI_Send_init(const void* b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c, MPI_Request* r) {
  const int code = timed([&] { return PMPI_Send_init(b, n, t, to, tag, c, r); });
  own.prepared[*r] = size_of(n, t);
  return code;
}
int MPI_Request_free(MPI_Request* r) {
  own.prepared.erase(*r);
  return PMPI_Request_free(r);
}
int MPI_Start(MPI_Request* r) {
  start_prepared(*r);
  return timed([&] { return PMPI_Start(r); });
}
int MPI_Startall(int n, MPI_Request* r) {
  for (int i = 0; i < n; ++i) start_prepared(r[i]);
  return timed([&] { return PMPI_Startall(n, r); });
}
int MPI_Recv(void* b, int n, MPI_Datatype t, int from, int tag, MPI_Comm c, MPI_Status* s) {
  return timed([&] { return PMPI_Recv(b, n, t, from, tag, c, s); });
}
int MPI_Irecv(void* b, int n, MPI_Datatype t, int from, int tag, MPI_Comm c, MPI_Request* r) {
  return timed([&] { return PMPI_Irecv(b, n, t, from, tag, c, r); });
}
int MPI_Wait(MPI_Request* r, MPI_Status* s) {
  return timed([&] { return PMPI_Wait(r, s); });
}
int MPI_Waitall(int n, MPI_Request* r, MPI_Status* s) {
  return timed([&] { return PMPI_Waitall(n, r, s); });
}
int MPI_Waitany(int n, MPI_Request* r, int* i, MPI_Status* s) {
  return timed([&] { return PMPI_Waitany(n, r, i, s); });
}
int MPI_Waitsome(int n, MPI_Request* r, int* done, int* i, MPI_Status* s) {
  return timed([&] { return PMPI_Waitsome(n, r, done, i, s); });
}
int MPI_Test(MPI_Request* r, int* f, MPI_Status* s) {
  return timed([&] { return PMPI_Test(r, f, s); });
}
int MPI_Testall(int n, MPI_Request* r, int* f, MPI_Status* s) {
  return timed([&] { return PMPI_Testall(n, r, f, s); });
}
int MPI_Probe(int from, int tag, MPI_Comm c, MPI_Status* s) {
  return timed([&] { return PMPI_Probe(from, tag, c, s); });
}
int MPI_Iprobe(int from, int tag, MPI_Comm c, int* f, MPI_Status* s) {
  return timed([&] { return PMPI_Iprobe(from, tag, c, f, s); });
}
int MPI_Improbe(int from, int tag, MPI_Comm c, int* f, MPI_Message* m, MPI_Status* s) {
  return timed([&] { return PMPI_Improbe(from, tag, c, f, m, s); });
}
int MPI_Barrier(MPI_Comm c) {
  return together([&] { return PMPI_Barrier(c); });
}
int MPI_Ibarrier(MPI_Comm c, MPI_Request* r) {
  return together([&] { return PMPI_Ibarrier(c, r); });
}
int MPI_Bcast(void* b, int n, MPI_Datatype t, int root, MPI_Comm c) {
  return together([&] { return PMPI_Bcast(b, n, t, root, c); });
}
int MPI_Reduce(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, int root, MPI_Comm c) {
  return together([&] { return PMPI_Reduce(a, b, n, t, o, root, c); });
}
int MPI_Allreduce(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c) {
  return together([&] { return PMPI_Allreduce(a, b, n, t, o, c); });
}
int MPI_Iallreduce(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c, MPI_Request* r) {
  return together([&] { return PMPI_Iallreduce(a, b, n, t, o, c, r); });
}
int MPI_Reduce_scatter_block(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c) {
  return together([&] { return PMPI_Reduce_scatter_block(a, b, n, t, o, c); });
}
int MPI_Scan(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c) {
  return together([&] { return PMPI_Scan(a, b, n, t, o, c); });
}
int MPI_Exscan(const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c) {
  return together([&] { return PMPI_Exscan(a, b, n, t, o, c); });
}
int MPI_Gather(const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, int root, MPI_Comm c) {
  return together([&] { return PMPI_Gather(a, n, t, b, m, u, root, c); });
}
int MPI_Gatherv(const void* a, int n, MPI_Datatype t, void* b, const int* m, const int* d, MPI_Datatype u, int root,
                MPI_Comm c) {
  return together([&] { return PMPI_Gatherv(a, n, t, b, m, d, u, root, c); });
}
int MPI_Scatter(const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, int root, MPI_Comm c) {
  return together([&] { return PMPI_Scatter(a, n, t, b, m, u, root, c); });
}
int MPI_Allgather(const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c) {
  return together([&] { return PMPI_Allgather(a, n, t, b, m, u, c); });
}
int MPI_Allgatherv(const void* a, int n, MPI_Datatype t, void* b, const int* m, const int* d, MPI_Datatype u,
                   MPI_Comm c) {
  return together([&] { return PMPI_Allgatherv(a, n, t, b, m, d, u, c); });
}
int MPI_Alltoall(const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c) {
  return together([&] { return PMPI_Alltoall(a, n, t, b, m, u, c); });
}
int MPI_Alltoallv(const void* a, const int* n, const int* d, MPI_Datatype t, void* b, const int* m, const int* e,
                  MPI_Datatype u, MPI_Comm c) {
  return together([&] { return PMPI_Alltoallv(a, n, d, t, b, m, e, u, c); });
}
}

namespace pamr::bench {

const MpiCounts& mpi_counts() { return own; }

}  // namespace pamr::bench
