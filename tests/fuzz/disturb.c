/* Loaded before the C library: one call on a watched file fails, or brings a signal.
 *
 * Watched are paths that are relative or begin with $DISTURB_UNDER, and what was opened by them.  They are
 * counted; $DISTURB_AT says which one is disturbed, $DISTURB_BY how: "error NUMBER" (errno), "lasting NUMBER"
 * (and so are all that follow, but those that remove) or "signal NUMBER".  $DISTURB_COUNT names a file that
 * receives their number at the end. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

enum { MOST = 4096 };
static long at, count, number;
static char kind;
static const char *under;
static char watched[MOST];
static pid_t own;

__attribute__((constructor)) static void begin(void) {
    const char *by = getenv("DISTURB_BY");
    under = getenv("DISTURB_UNDER");
    at = getenv("DISTURB_AT") ? atol(getenv("DISTURB_AT")) : 0;
    kind = by ? by[0] : 0;
    number = by && strchr(by, ' ') ? atol(strchr(by, ' ')) : 0;
    own = getpid();
}

__attribute__((destructor)) static void end(void) {
    const char *path = getenv("DISTURB_COUNT");
    FILE *file = path && getpid() == own ? fopen(path, "w") : NULL;
    if (file) {
        fprintf(file, "%ld\n", count);
        fclose(file);
    }
}

static int is_watched(const char *path) {
    return under && path && getpid() == own && (path[0] != '/' || strncmp(path, under, strlen(under)) == 0);
}

/* Whether this call is to fail; errno is set then. */
static int disturbed(int removes) {
    count++;
    if (at == 0 || count < at || (count > at && (kind != 'l' || removes))) return 0;
    if (kind == 's') {
        kill(own, (int)number);
        return 0;
    }
    errno = (int)number;
    return 1;
}

static int is_open(int fd) { return fd >= 0 && fd < MOST && watched[fd] && getpid() == own; }

#define REAL(type, name, ...) type (*real)(__VA_ARGS__) = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

#define OPEN(name)                                                            \
    int name(const char *path, int flags, ...) {                              \
        REAL(int, #name, const char *, int, ...);                             \
        va_list rest;                                                         \
        va_start(rest, flags);                                                \
        int mode = va_arg(rest, int);                                         \
        va_end(rest);                                                         \
        int mine = is_watched(path);                                          \
        if (mine && disturbed(0)) return -1;                                  \
        int fd = real(path, flags, mode);                                     \
        if (fd >= 0 && fd < MOST) watched[fd] = (char)mine;                   \
        return fd;                                                            \
    }
OPEN(open)
OPEN(open64)

#define ON_PATH(name, removes)                                                \
    int name(const char *path) {                                              \
        REAL(int, #name, const char *);                                       \
        return is_watched(path) && disturbed(removes) ? -1 : real(path);      \
    }
ON_PATH(unlink, 1)
ON_PATH(rmdir, 1)

#define ON_TWO(name)                                                          \
    int name(const char *path, const char *other) {                           \
        REAL(int, #name, const char *, const char *);                         \
        return is_watched(path) && disturbed(0) ? -1 : real(path, other);     \
    }
ON_TWO(rename)
ON_TWO(link)

#define ON_MODE(name)                                                         \
    int name(const char *path, mode_t mode) {                                 \
        REAL(int, #name, const char *, mode_t);                               \
        return is_watched(path) && disturbed(0) ? -1 : real(path, mode);      \
    }
ON_MODE(mkdir)
ON_MODE(chmod)

#define ON_STATUS(name, type)                                                 \
    int name(const char *path, type *found) {                                 \
        REAL(int, #name, const char *, type *);                               \
        return is_watched(path) && disturbed(0) ? -1 : real(path, found);     \
    }
ON_STATUS(stat, struct stat)
ON_STATUS(stat64, struct stat64)
ON_STATUS(lstat, struct stat)
ON_STATUS(lstat64, struct stat64)

#define ON_FILE(name)                                                         \
    int name(int fd) {                                                        \
        REAL(int, #name, int);                                                \
        return is_open(fd) && disturbed(0) ? -1 : real(fd);                   \
    }
ON_FILE(fsync)
ON_FILE(fdatasync)

int close(int fd) {
    REAL(int, "close", int);
    int fails = is_open(fd) && disturbed(1), why = errno;
    if (fd >= 0 && fd < MOST) watched[fd] = 0;
    int done = real(fd);
    if (fails) errno = why;
    return fails ? -1 : done;
}

ssize_t write(int fd, const void *data, size_t size) {
    REAL(ssize_t, "write", int, const void *, size_t);
    if (!is_open(fd) || !disturbed(0)) return real(fd, data, size);
    if (errno == EINTR || size < 2) return -1;
    at = count + 1; /* some of it has room, and what follows has none */
    return real(fd, data, size / 2);
}

ssize_t read(int fd, void *data, size_t size) {
    REAL(ssize_t, "read", int, void *, size_t);
    return is_open(fd) && disturbed(0) ? -1 : real(fd, data, size);
}
