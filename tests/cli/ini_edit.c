/// Changing values in INI files: what must stay stays to the byte.
#include "ini_edit.h"

#include "check.h"
#include "support/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void expect_edit(const char *text, const struct ini_change *changes, unsigned count,
                        const char *wanted) {
    struct ini ini = {0};
    FILE *stream = messages_input(text, strlen(text));
    size_t size = 0;
    CHECK_EQ(ini_read_stream(stream, "test", &ini), EXIT_STATUS_OK);
    fclose(stream);
    char *edited = ini_edit_text(text, strlen(text), &ini, changes, count, &size);
    if (!CHECK(edited != NULL && size == strlen(wanted) && memcmp(edited, wanted, size) == 0)) {
        printf("--- got\n%s--- wanted\n%s---\n", edited, wanted);
    }
    free(edited);
    ini_free(&ini);
}

static void values_change_and_nothing_else(void) {
    const struct ini_change change[] = {{"pan", "limit", "12.5", ""}};
    expect_edit("[pan]\nlimit = 7\n", change, 1, "[pan]\nlimit = 12.5\n");
    expect_edit(
        "# top\n\n [pan] ; p\n\tlimit=7\t # cable; do not raise\n\n[tilt]\nlimit = 7 # 7\n", change,
        1, "# top\n\n [pan] ; p\n\tlimit=12.5\t # cable; do not raise\n\n[tilt]\nlimit = 7 # 7\n");
    expect_edit("[pan]\r\nlimit = 7 ;x\r\nother = 1\r\n", change, 1,
                "[pan]\r\nlimit = 12.5 ;x\r\nother = 1\r\n");
    expect_edit("[pan]\nlimit = 7", change, 1, "[pan]\nlimit = 12.5");
    expect_edit("[pan]\nlimit = a#b=c ;d\n", change, 1, "[pan]\nlimit = 12.5 ;d\n");
    expect_edit("\xEF\xBB\xBF[pan]\nlimit =   1,  2   \n", change, 1,
                "\xEF\xBB\xBF[pan]\nlimit =   12.5   \n");
    // The name in a comment, and in a longer name.
    expect_edit("[pan]\n# limit = 1\nlimit_min = 1\nlimit = 2\n", change, 1,
                "[pan]\n# limit = 1\nlimit_min = 1\nlimit = 12.5\n");
}

/// Behind the person's own comment, and in the place of an older note.
static void notes_stand_behind(void) {
    const struct ini_change change[] = {{"pan", "limit", "12.5", "today: by hand"},
                                        {"pan", "new", "1", "today"}};
    expect_edit("[pan]\nlimit = 7\n", change, 2,
                "[pan]\nlimit = 12.5 # measured today: by hand\nnew = 1 # measured today\n");
    expect_edit("[pan]\nlimit = 7\t; the cable\nnew = 0 #mine\n", change, 2,
                "[pan]\nlimit = 12.5\t; the cable # measured today: by hand\n"
                "new = 1 #mine # measured today\n");
    expect_edit("[pan]\r\nlimit = 7 ; the cable # measured long ago\r\nnew = 0   # measured x\r\n",
                change, 2,
                "[pan]\r\nlimit = 12.5 ; the cable # measured today: by hand\r\n"
                "new = 1 # measured today\r\n");
    const struct ini_change bare[] = {{"pan", "limit", "3", ""}}; // no note: the old one goes
    expect_edit("[pan]\nlimit = 7 # a # measured long ago\n", bare, 1, "[pan]\nlimit = 3 # a\n");
}

static void new_keys_go_behind_the_last_of_their_section(void) {
    const struct ini_change change[] = {{"pan", "new", "1", ""}, {"pan", "newer", "2", ""}};
    expect_edit("[pan]\na = 1 # x\n# about b\nb = 2\n\n# about tilt\n[tilt]\nc = 3\n", change, 2,
                "[pan]\na = 1 # x\n# about b\nb = 2\nnew = 1\nnewer = 2\n\n# about tilt\n[tilt]\nc "
                "= 3\n");
    expect_edit("[tilt]\nb = 1\n[pan]\na = 1", change, 2,
                "[tilt]\nb = 1\n[pan]\na = 1\nnew = 1\nnewer = 2\n");
    expect_edit("[pan]\r\na = 1\r\n", change, 2, "[pan]\r\na = 1\r\nnew = 1\r\nnewer = 2\r\n");
}

static void new_sections_go_to_the_end(void) {
    const struct ini_change change[] = {
        {"mount", "heading", "1", ""}, {"pan", "a", "9", ""}, {"mount", "roll", "2", ""}};
    expect_edit("[pan]\na = 1\n", change, 3, "[pan]\na = 9\n\n[mount]\nheading = 1\nroll = 2\n");
    expect_edit("[pan]\na = 1", change, 3, "[pan]\na = 9\n\n[mount]\nheading = 1\nroll = 2\n");
}

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    CHECK(file != NULL && fputs(text, file) >= 0 && fclose(file) == 0);
}

static bool file_is(const char *path, const char *wanted) {
    char text[200] = "";
    FILE *file = fopen(path, "r");
    const size_t size = file == NULL ? 0U : fread(text, 1, sizeof text - 1U, file);
    if (file != NULL) {
        fclose(file);
    }
    text[size] = '\0';
    return strcmp(text, wanted) == 0;
}

/// Through a symbolic link, with its permissions; not if somebody else was faster.
static void files_are_replaced_whole(void) {
    char folder[] = "/tmp/boresight-ini-XXXXXX", path[64], link_path[64];
    CHECK(mkdtemp(folder) != NULL);
    snprintf(path, sizeof path, "%s/rig.ini", folder);
    snprintf(link_path, sizeof link_path, "%s/link.ini", folder);
    const struct ini_change change = {"pan", "a", "2", ""};
    struct ini ini = {0};
    write_file(path, "[pan]\na = 1 # x\n");
    CHECK_EQ(chmod(path, 0640), 0);
    CHECK_EQ(symlink("rig.ini", link_path), 0);
    CHECK_EQ(ini_read(link_path, &ini), EXIT_STATUS_OK);
    CHECK_EQ(ini_edit_file(&ini, &change, 1), EXIT_STATUS_OK);
    struct stat about;
    CHECK(file_is(path, "[pan]\na = 2 # x\n"));
    CHECK(stat(path, &about) == 0 && (about.st_mode & 07777U) == 0640U);
    CHECK(lstat(link_path, &about) == 0 && S_ISLNK(about.st_mode));

    struct messages messages;
    char wanted[200];
    messages_start(&messages); // the file has a 2 now, and ini the 1 of before
    CHECK_EQ(ini_edit_file(&ini, &change, 1), EXIT_STATUS_FAILURE);
    snprintf(wanted, sizeof wanted, "%s: was changed meanwhile: nothing is written\n", link_path);
    messages_were(&messages, wanted);
    CHECK(file_is(path, "[pan]\na = 2 # x\n"));
    ini_free(&ini);
    CHECK(unlink(path) == 0 && unlink(link_path) == 0);
    CHECK_EQ(rmdir(folder), 0); // no part of a new file is left
}

int main(void) {
    TEST(values_change_and_nothing_else);
    TEST(notes_stand_behind);
    TEST(new_keys_go_behind_the_last_of_their_section);
    TEST(new_sections_go_to_the_end);
    TEST(files_are_replaced_whole);
    return check_finish();
}
