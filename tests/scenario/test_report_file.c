/// A report appears on disk whole or not at all.
#include "check.h"
#include "view/report.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "build/report-test.XXXXXX";
static char file_path[64];

static bool holds(const char *beginning) {
    char text[32] = "";
    FILE *file = fopen(file_path, "rb");
    size_t size = file == NULL ? 0 : fread(text, 1, sizeof text - 1, file);
    if (file != NULL) {
        fclose(file);
    }
    return size >= strlen(beginning) && strncmp(text, beginning, strlen(beginning)) == 0;
}

/// How many entries the test's folder has.
static int files_in_folder(void) {
    int count = 0;
    DIR *open = opendir(folder);
    for (struct dirent *entry; open != NULL && (entry = readdir(open)) != NULL;) {
        count += entry->d_name[0] != '.';
    }
    closedir(open);
    return count;
}

static void what_cannot_be_written_leaves_nothing(void) {
    struct report report;
    report_init(&report, "Unwritten", "");
    const struct report *chapters[] = {&report};
    char path[128];
    snprintf(path, sizeof path, "%s/none/report.html", folder);
    CHECK(!report_write(chapters, 1, path));
    CHECK_EQ(errno, ENOENT);
    CHECK(!report_write(chapters, 1, folder));
    CHECK_EQ(errno, EISDIR);
    snprintf(path, sizeof path, "%s/below", file_path); // below a file
    CHECK(report_write(chapters, 1, file_path));
    CHECK(!report_write(chapters, 1, path));
    CHECK_EQ(errno, ENOTDIR);
    snprintf(path, sizeof path, "%s/pipe", folder); // a device must not be replaced by a file
    CHECK(mkfifo(path, 0600) == 0);
    CHECK(!report_write(chapters, 1, path));
    struct stat there;
    CHECK(stat(path, &there) == 0 && S_ISFIFO(there.st_mode));
    unlink(path);
    char name[5000];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    CHECK(!report_write(chapters, 1, name));
    CHECK_EQ(errno, ENAMETOOLONG);
    CHECK_EQ(files_in_folder(), 1);
    report_free(&report);
}

static void a_full_disk_leaves_the_old_file(void) {
    struct report report;
    report_init(&report, "Too large for the disk", "");
    const struct report *chapters[] = {&report};
    FILE *old = fopen(file_path, "w");
    fputs("old", old);
    fclose(old);
    // A limit on the size of files fails like a full disk, in the middle of writing.
    struct rlimit limit, low;
    signal(SIGXFSZ, SIG_IGN);
    CHECK(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    low = limit;
    low.rlim_cur = 1000;
    setrlimit(RLIMIT_FSIZE, &low);
    bool written = report_write(chapters, 1, file_path);
    int why = errno;
    setrlimit(RLIMIT_FSIZE, &limit);
    CHECK(!written);
    CHECK_EQ(why, EFBIG);
    CHECK(holds("old"));
    CHECK_EQ(files_in_folder(), 1);
    report_free(&report);
}

static void a_link_is_followed(void) {
    struct report report;
    report_init(&report, "Behind a link", "");
    const struct report *chapters[] = {&report};
    char link[128];
    struct stat there;
    snprintf(link, sizeof link, "%s/link", folder);
    CHECK(symlink(strrchr(file_path, '/') + 1, link) == 0);
    CHECK(report_write(chapters, 1, link));
    CHECK(lstat(link, &there) == 0 && S_ISLNK(there.st_mode));
    CHECK(holds("<!DOCTYPE html>"));
    unlink(file_path);
    CHECK(!report_write(chapters, 1, link)); // now it leads nowhere
    unlink(link);
    CHECK_EQ(files_in_folder(), 0);
    report_free(&report);
}

int main(void) {
    if (mkdtemp(folder) == NULL) {
        printf("FAIL report_file cannot make a folder in build/\n");
        return 1;
    }
    snprintf(file_path, sizeof file_path, "%s/report.html", folder);
    TEST(what_cannot_be_written_leaves_nothing);
    TEST(a_full_disk_leaves_the_old_file);
    TEST(a_link_is_followed);
    unlink(file_path);
    rmdir(folder);
    return check_finish();
}
