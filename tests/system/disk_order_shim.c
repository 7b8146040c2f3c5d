// Loaded before the C library (LD_PRELOAD): notes in the file DYNCAL_DISK_ORDER, in their order,
// what reaches the disk: "sync PATH" once it is there, "name PATH" for a file that took its last
// name, and "write PATH" for a database.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void note(const char* what, const char* path) {
  const char* log = getenv("DYNCAL_DISK_ORDER");
  if (log == NULL) {
    return;
  }
  char line[PATH_MAX + 32];
  const int size = snprintf(line, sizeof(line), "%s %s\n", what, path);
  const int file = open(log, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (file >= 0 && write(file, line, (size_t)size) == size) {
    close(file);
  }
}

static void note_file(const char* what, int file, const char* only) {
  char link[64];
  char path[PATH_MAX];
  snprintf(link, sizeof(link), "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, path, sizeof(path) - 1);
  path[size > 0 ? size : 0] = '\0';
  if (strstr(path, only) != NULL) {
    note(what, path);
  }
}

static void* next_one(const char* name) {
  return dlsym(RTLD_NEXT, name);
}

int fsync(int file) {
  const int failed = ((int (*)(int))next_one("fsync"))(file);
  if (failed == 0) {
    note_file("sync", file, "");
  }
  return failed;
}

int rename(const char* from, const char* to) {
  const int failed = ((int (*)(const char*, const char*))next_one("rename"))(from, to);
  if (failed == 0) {
    note("name", to);
  }
  return failed;
}

ssize_t pwrite64(int file, const void* data, size_t size, off64_t offset) {
  note_file("write", file, ".sqlite");
  return ((ssize_t(*)(int, const void*, size_t, off64_t))next_one("pwrite64"))(file, data, size,
                                                                               offset);
}

ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  note_file("write", file, ".sqlite");
  return ((ssize_t(*)(int, const void*, size_t, off_t))next_one("pwrite"))(file, data, size,
                                                                           offset);
}
