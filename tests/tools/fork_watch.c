/* SPDX-License-Identifier: GPL-3.0-or-later
 * Preloaded into a tool (LD_PRELOAD): ends a process that forks once MPI runs in it, with exit code 70. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

static void watch(void) {
  static const char text[] = "a process of an MPI job forks\n";
  int (*initialized)(int*) = (int (*)(int*))dlsym(RTLD_DEFAULT, "MPI_Initialized");
  int runs = 0;
  if (initialized == NULL || initialized(&runs) != 0 || !runs) return; /* mpirun, or a tool before MPI */
  if (write(STDERR_FILENO, text, sizeof(text) - 1) < 0) _exit(71);
  _exit(70);
}

__attribute__((constructor)) static void begin(void) { pthread_atfork(watch, NULL, NULL); }
