// For LD_PRELOAD under User-Mode-Linux 6.1, which hands the host's ptrace a buffer for the
// floating-point state that is too small for processors with AMX: there the host refuses (EFAULT)
// and the guest stops at its first program.
//
// Registers are fetched into a buffer that is large enough and cut to what the guest asked for;
// what the guest sets is laid over a zeroed buffer of the full size, so that the state which the
// guest does not know of is in its initial form. Needless elsewhere, and harmless.
#define _GNU_SOURCE
#include <elf.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#ifndef NT_X86_XSTATE
#define NT_X86_XSTATE 0x202
#endif

static unsigned char state[1 << 16] __attribute__((aligned(64)));
static size_t size_of_host; // 0: not known yet

static long get_state(long pid, struct iovec* wanted) {
  struct iovec full = {state, sizeof state};
  const long result = syscall(SYS_ptrace, (long)PTRACE_GETREGSET, pid, (long)NT_X86_XSTATE, &full);
  if (result < 0) {
    return result;
  }
  size_of_host = full.iov_len;
  if (wanted->iov_len > full.iov_len) {
    wanted->iov_len = full.iov_len;
  }
  memcpy(wanted->iov_base, state, wanted->iov_len);
  return 0;
}

static long set_state(long pid, const struct iovec* given) {
  if (given->iov_len >= size_of_host) {
    return syscall(SYS_ptrace, (long)PTRACE_SETREGSET, pid, (long)NT_X86_XSTATE, given);
  }
  memcpy(state, given->iov_base, given->iov_len);
  memset(state + given->iov_len, 0, size_of_host - given->iov_len);
  struct iovec full = {state, size_of_host};
  return syscall(SYS_ptrace, (long)PTRACE_SETREGSET, pid, (long)NT_X86_XSTATE, &full);
}

long ptrace(enum __ptrace_request request, ...) {
  va_list arguments;
  va_start(arguments, request);
  const long pid = va_arg(arguments, int);
  void* const address = va_arg(arguments, void*);
  void* const data = va_arg(arguments, void*);
  va_end(arguments);
  const int about_state = (long)address == NT_X86_XSTATE;
  if (about_state && request == PTRACE_GETREGSET) {
    return get_state(pid, data);
  }
  if (about_state && request == PTRACE_SETREGSET) {
    return set_state(pid, data);
  }
  if (request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER) {
    long word = 0; // the system call stores what the library function returns
    if (syscall(SYS_ptrace, (long)request, pid, address, &word) < 0) {
      return -1;
    }
    errno = 0;
    return word;
  }
  return syscall(SYS_ptrace, (long)request, pid, address, data);
}
