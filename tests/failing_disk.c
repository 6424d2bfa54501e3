/* A machine that fails: preloaded into a program, it lets one of its calls fail that writes under a folder.
 *
 * FAILING_UNDER   the folder; without it nothing happens to files
 * FAILING_CALL    which calls are counted: open write sync rename link mkdir resize close, or all of them: any;
 *                 or else: read, under the folder; bind, of a port; clock, which is set back by an hour
 * FAILING_NUMBER  the first of them that fails; 0: none
 * FAILING_ERRNO   with what; 0: the process is killed there
 * FAILING_LASTS   1: all that follow fail, too, as on a full disk
 * FAILING_STATE   a file of 16 bytes, which all processes share: how many calls were counted, how many have failed
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

static int is_under(const char *path) {
    const char *folder = getenv("FAILING_UNDER");
    return folder && *folder && strncmp(path, folder, strlen(folder)) == 0;
}

static int path_under(int at, const char *path) {
    char whole[PATH_MAX * 2], base[PATH_MAX], link[64];
    if (path[0] == '/')
        return is_under(path);
    if (at == AT_FDCWD)
        strcpy(link, "/proc/self/cwd");
    else
        snprintf(link, sizeof link, "/proc/self/fd/%d", at);
    ssize_t length = readlink(link, base, sizeof base - 1);
    if (length < 0)
        return 0;
    base[length] = 0;
    snprintf(whole, sizeof whole, "%s/%s", base, path);
    return is_under(whole);
}

static int file_under(int file) {
    char link[64], path[PATH_MAX];
    if (!getenv("FAILING_UNDER"))
        return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0)
        return 0;
    path[length] = 0;
    return is_under(path);
}

static int64_t *state(void) {
    static int64_t *shared;
    static char known[PATH_MAX];
    const char *name = getenv("FAILING_STATE");
    if (!name)
        return NULL;
    if (!shared || strcmp(known, name)) {
        int file = syscall(SYS_openat, AT_FDCWD, name, O_RDWR | O_CLOEXEC);
        if (file < 0)
            return NULL;
        void *made = mmap(NULL, 16, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        syscall(SYS_close, file);
        if (made == MAP_FAILED)
            return NULL;
        shared = made;
        snprintf(known, sizeof known, "%s", name);
    }
    return shared;
}

/* Count a call; return whether it fails, with errno. */
static int fails(const char *call) {
    int is_write = strcmp(call, "read") && strcmp(call, "bind") && strcmp(call, "clock");
    const char *wanted = getenv("FAILING_CALL"), *number = getenv("FAILING_NUMBER");
    const char *with = getenv("FAILING_ERRNO"), *lasts = getenv("FAILING_LASTS");
    int64_t *shared = state();
    if (!shared || !wanted || (strcmp(wanted, is_write ? "any" : call) && strcmp(wanted, call)))
        return 0;
    int64_t first = number ? atoll(number) : 0;
    int64_t count = __atomic_add_fetch(&shared[0], 1, __ATOMIC_SEQ_CST);
    if (!first || count < first || (count > first && !(lasts && *lasts == '1')))
        return 0;
    __atomic_add_fetch(&shared[1], 1, __ATOMIC_SEQ_CST);
    errno = with ? atoi(with) : ENOSPC;
    if (!errno)
        kill(getpid(), SIGKILL);
    return 1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define WRITES(flags) ((flags) & (O_WRONLY | O_RDWR | O_CREAT))

#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        va_list more; \
        va_start(more, flags); \
        mode_t mode = va_arg(more, mode_t); \
        va_end(more); \
        if (WRITES(flags) && path_under(AT_FDCWD, path) && fails("open")) \
            return -1; \
        return REAL(name)(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)

#define OPENAT(name) \
    int name(int at, const char *path, int flags, ...) { \
        va_list more; \
        va_start(more, flags); \
        mode_t mode = va_arg(more, mode_t); \
        va_end(more); \
        if (WRITES(flags) && path_under(at, path) && fails("open")) \
            return -1; \
        return REAL(name)(at, path, flags, mode); \
    }
OPENAT(openat)
OPENAT(openat64)

#define FOPEN(name) \
    FILE *name(const char *path, const char *mode) { \
        if (strpbrk(mode, "wa+") && path_under(AT_FDCWD, path) && fails("open")) \
            return NULL; \
        return REAL(name)(path, mode); \
    }
FOPEN(fopen)
FOPEN(fopen64)

#define ON_FILE(call, result, name, arguments, given) \
    result name arguments { \
        if (file_under(file) && fails(call)) \
            return -1; \
        return REAL(name) given; \
    }
ON_FILE("write", ssize_t, write, (int file, const void *data, size_t size), (file, data, size))
ON_FILE("write", ssize_t, writev, (int file, const struct iovec *parts, int count), (file, parts, count))
ON_FILE("write", ssize_t, pwrite, (int file, const void *data, size_t size, off_t at), (file, data, size, at))
ON_FILE("write", ssize_t, pwrite64, (int file, const void *data, size_t size, off64_t at), (file, data, size, at))
ON_FILE("sync", int, fsync, (int file), (file))
ON_FILE("sync", int, fdatasync, (int file), (file))
ON_FILE("resize", int, ftruncate, (int file, off_t size), (file, size))
ON_FILE("resize", int, ftruncate64, (int file, off64_t size), (file, size))

int posix_fallocate(int file, off_t at, off_t size) {
    return file_under(file) && fails("resize") ? errno : REAL(posix_fallocate)(file, at, size);
}

int close(int file) { /* what fails is closed, too */
    int flags = fcntl(file, F_GETFL);
    int failed = flags >= 0 && (flags & (O_WRONLY | O_RDWR)) && file_under(file) && fails("close");
    int error = errno, result = REAL(close)(file);
    if (!failed)
        return result;
    errno = error;
    return -1;
}

#define ON_PATH(call, name, arguments, given, at, path) \
    int name arguments { \
        if (path_under(at, path) && fails(call)) \
            return -1; \
        return REAL(name) given; \
    }
ON_PATH("rename", rename, (const char *from, const char *to), (from, to), AT_FDCWD, to)
ON_PATH("rename", renameat, (int a, const char *from, int b, const char *to), (a, from, b, to), b, to)
ON_PATH("link", link, (const char *from, const char *to), (from, to), AT_FDCWD, to)
ON_PATH("link", linkat, (int a, const char *from, int b, const char *to, int how), (a, from, b, to, how), b, to)
ON_PATH("link", symlink, (const char *what, const char *path), (what, path), AT_FDCWD, path)
ON_PATH("mkdir", mkdir, (const char *path, mode_t mode), (path, mode), AT_FDCWD, path)
ON_PATH("mkdir", mkdirat, (int at, const char *path, mode_t mode), (at, path, mode), at, path)
ON_PATH("resize", truncate, (const char *path, off_t size), (path, size), AT_FDCWD, path)
ON_PATH("resize", truncate64, (const char *path, off64_t size), (path, size), AT_FDCWD, path)

ON_FILE("read", ssize_t, read, (int file, void *data, size_t size), (file, data, size))
ON_FILE("read", ssize_t, readv, (int file, const struct iovec *parts, int count), (file, parts, count))
ON_FILE("read", ssize_t, pread, (int file, void *data, size_t size, off_t at), (file, data, size, at))
ON_FILE("read", ssize_t, pread64, (int file, void *data, size_t size, off64_t at), (file, data, size, at))

int bind(int socket, const struct sockaddr *address, socklen_t size) {
    int has_port = address->sa_family == AF_INET || address->sa_family == AF_INET6;
    return has_port && fails("bind") ? -1 : REAL(bind)(socket, address, size);
}

#define HOUR 3600
int clock_gettime(clockid_t clock, struct timespec *now) {
    int result = REAL(clock_gettime)(clock, now);
    if (clock == CLOCK_REALTIME && fails("clock"))
        now->tv_sec -= HOUR;
    return result;
}

int gettimeofday(struct timeval *now, void *zone) {
    int result = REAL(gettimeofday)(now, zone);
    if (fails("clock"))
        now->tv_sec -= HOUR;
    return result;
}

time_t time(time_t *also) {
    time_t now = REAL(time)(NULL) - (fails("clock") ? HOUR : 0);
    if (also)
        *also = now;
    return now;
}
