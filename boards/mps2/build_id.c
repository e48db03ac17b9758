/// Test images say this instead of a commit, which would link each of them anew at every one.
extern const char build_id[];
const char build_id[] = "test image";
