/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loaded before a tool (LD_PRELOAD), it makes the system misbehave as the variable FAULT says:
 *
 *   no-fork      processes cannot be started (a sandbox)
 *   quota:N      files take no more than N bytes in all, then EDQUOT (a user's quota)
 *   worn:N       space is given, but what is written after N bytes fails with EIO (a bad disk)
 *   broken:N     files can be read for N bytes in all, then EIO (a bad disk)
 *   dies:N       the process is killed when it has written N bytes
 *   dies-before  it is killed when it is about to give a file or folder its name
 *   dies-after   it is killed right after that
 *   clock        the time of day jumps forth and back by an hour at every look
 *
 * memory_shim.cpp has another.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static const char* fault_of(const char* name) {
  const char* fault = getenv("FAULT");
  const size_t n = strlen(name);
  return fault != NULL && strncmp(fault, name, n) == 0 ? fault + n : NULL;
}

static void* next(const char* name) {
  return dlsym(RTLD_NEXT, name);
}

/* A user's file: not a pipe, no memory that has a file's face, which lies in no folder of /dev/shm, nothing of the system, and nothing of
   Open MPI's. */
static int is_file(int fd) {
  struct stat status;
  char name[32], target[4096] = {0};
  if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
  if (readlink(name, target, sizeof target - 1) <= 0) return 0;
  static const char memory[] = "/dev/shm/";
  if (strncmp(target, memory, strlen(memory)) == 0 && strchr(target + strlen(memory), '/') == NULL) return 0;
  static const char* const others[] = {"/memfd:", "/proc/", "/sys/", "/usr/", "/etc/"};
  for (size_t i = 0; i < sizeof others / sizeof *others; ++i)
    if (strncmp(target, others[i], strlen(others[i])) == 0) return 0;
  return strstr(target, "/ompi.") == NULL && strstr(target, "/OMPIO_") == NULL;
}

/* 1, with errno set, if `bytes` more of a file are beyond what the fault allows. */
static int stops(const char* name, long* so_far, int error, int fd, size_t bytes) {
  const char* limit = fault_of(name);
  if (limit == NULL || !is_file(fd)) return 0;
  if (__atomic_add_fetch(so_far, (long)bytes, __ATOMIC_RELAXED) <= atol(limit)) return 0;
  errno = error;
  return 1;
}

static long written, worn, red;

/* Kills the process if `bytes` more of a file are beyond what it may live to write. */
static void dies(int fd, size_t bytes) {
  static long alive;
  const int error = errno;
  if (stops("dies:", &alive, 0, fd, bytes)) raise(SIGKILL);
  errno = error;
}

static size_t sum(const struct iovec* parts, int n) {
  size_t bytes = 0;
  for (int i = 0; i < n; ++i) bytes += parts[i].iov_len;
  return bytes;
}

#define WRITES(result, name, bytes, parameters, ...)                    \
  result name parameters {                                              \
    dies(fd, bytes);                                                    \
    if (stops("quota:", &written, EDQUOT, fd, bytes) || stops("worn:", &worn, EIO, fd, bytes)) return -1; \
    return ((result(*) parameters)next(#name))(__VA_ARGS__);            \
  }
WRITES(ssize_t, write, n, (int fd, const void* p, size_t n), fd, p, n)
WRITES(ssize_t, pwrite, n, (int fd, const void* p, size_t n, off_t at), fd, p, n, at)
WRITES(ssize_t, pwrite64, n, (int fd, const void* p, size_t n, off64_t at), fd, p, n, at)
WRITES(ssize_t, writev, sum(p, n), (int fd, const struct iovec* p, int n), fd, p, n)
WRITES(ssize_t, pwritev, sum(p, n), (int fd, const struct iovec* p, int n, off_t at), fd, p, n, at)
WRITES(ssize_t, pwritev64, sum(p, n), (int fd, const struct iovec* p, int n, off64_t at), fd, p, n, at)

#define READS(result, name, bytes, parameters, ...)                     \
  result name parameters {                                              \
    if (stops("broken:", &red, EIO, fd, bytes)) return -1;              \
    return ((result(*) parameters)next(#name))(__VA_ARGS__);            \
  }
READS(ssize_t, read, n, (int fd, void* p, size_t n), fd, p, n)
READS(ssize_t, pread, n, (int fd, void* p, size_t n, off_t at), fd, p, n, at)
READS(ssize_t, pread64, n, (int fd, void* p, size_t n, off64_t at), fd, p, n, at)

int fallocate(int fd, int mode, off_t at, off_t n) {
  if (stops("quota:", &written, EDQUOT, fd, (size_t)n)) return -1;
  return ((int (*)(int, int, off_t, off_t))next("fallocate"))(fd, mode, at, n);
}

int fallocate64(int fd, int mode, off64_t at, off64_t n) {
  return fallocate(fd, mode, at, n);
}

static void dies_at_rename(const char* when) {
  if (fault_of(when) != NULL) raise(SIGKILL);
}

int rename(const char* from, const char* to) {
  dies_at_rename("dies-before");
  const int result = ((int (*)(const char*, const char*))next("rename"))(from, to);
  dies_at_rename("dies-after");
  return result;
}

int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  dies_at_rename("dies-before");
  const int result = ((int (*)(int, const char*, int, const char*, unsigned))next("renameat2"))(a, from, b, to, flags);
  dies_at_rename("dies-after");
  return result;
}

pid_t fork(void) {
  if (fault_of("no-fork") != NULL) {
    errno = EAGAIN;
    return -1;
  }
  return ((pid_t(*)(void))next("fork"))();
}

static long jump(void) {
  static unsigned looks;
  return __atomic_add_fetch(&looks, 1, __ATOMIC_RELAXED) % 2 == 0 ? 3600 : -3600;
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  const int result = ((int (*)(clockid_t, struct timespec*))next("clock_gettime"))(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME && fault_of("clock") != NULL) time->tv_sec += jump();
  return result;
}

int gettimeofday(struct timeval* restrict time, void* restrict zone) {
  const int result = ((int (*)(struct timeval*, void*))next("gettimeofday"))(time, zone);
  if (result == 0 && fault_of("clock") != NULL) time->tv_sec += jump();
  return result;
}

time_t time(time_t* where) {
  time_t now = ((time_t(*)(time_t*))next("time"))(NULL);
  if (fault_of("clock") != NULL) now += jump();
  if (where != NULL) *where = now;
  return now;
}
