# Benchmarks: none of their figures is part of `make check`, for machines are noisy.
bench_o := $(patsubst tests/bench/%,$(B)/gcc/tests/bench/%.o,$(basename $(wildcard tests/bench/*.c tests/bench/*.cpp)))
$(B)/gcc/tests/bench/peers.o: tests/bench/peers.cpp
	@mkdir -p $(@D)
	$(say) CXX $@
	g++ -std=c++17 -O2 -DNDEBUG -Wall -Wextra -Werror -Ifirmware -Ihal/include -Itests -MMD -MP -c $< -o $@
-include $(bench_o:.o=.d)

$(B)/bench-cone: $(bench_o) $(B)/gcc/libfirmware.a
	$(say) LD $@
	g++ -o $@ $^ -lmpfr -lgmp -lm

# Without the other programs, and fewer sets: `make check` sees that it runs (tests/gate/bench.sh).
$(B)/bench-cone-alone: $(filter-out %/peers.o,$(bench_o)) $(B)/gcc/libfirmware.a
	$(say) LD $@
	gcc -o $@ $^ -lm
$(B)/check/script/tests/gate/bench.log: $(B)/bench-cone-alone

.PHONY: bench-cone
bench-cone: ## Measure the narrowest cone and the hull beside a bare pass and other programs
	@.ci/need bench
	@$(MAKE) --no-print-directory $(B)/bench-cone
	+@sh tests/bench/cone.sh $(B)/bench-cone $(B)/bench

bench_scene_o := $(B)/gcc/tests/bench/scene/main.o $(B)/gcc/tests/bench/peers.o $(B)/gcc/tests/bench/methods.o
-include $(bench_scene_o:.o=.d)
$(B)/bench-scene: $(bench_scene_o) $(B)/gcc/libtest.a $(gcc_libs)
	$(say) LD $@
	g++ -o $@ $^ -Wl,--as-needed -ljansson $(feature_libs) -lmpfr -lgmp -lm

.PHONY: bench-scene
bench-scene: ## Measure how many points aiming at a scene reads, beside the flat solver and CGAL (LARGE=1000000: up to that)
	@.ci/need bench
	@$(MAKE) --no-print-directory $(B)/bench-scene
	@mkdir -p $(B)/bench
	@LARGE=$(LARGE) $(B)/bench-scene | tee $(B)/bench/scene.txt; ! grep -q 'BOUND IS BROKEN' $(B)/bench/scene.txt

-include $(B)/gcc/tests/bench/regular/growth.d
.PHONY: bench-regular
bench-regular: $(B)/gcc/tests/bench/regular/growth ## Count how the cost of regular projections grows, and time how far they reach
	@mkdir -p $(B)/bench
	@$< | tee $(B)/bench/regular.txt

detect_frames := $(foreach t,tag marker motion,$(B)/gcc/tests/property/$(t)_frames)
.PHONY: bench-detect
bench-detect: $(detect_frames) ## Count the instructions of the detectors on rendered frames
	@.ci/need bench
	@sh tests/bench/detect.sh $(B)

levine_o := $(patsubst %.c,$(B)/gcc/%.o,$(wildcard tests/bench/levine/*.c))
-include $(levine_o:.o=.d)
$(B)/bench-levine: $(levine_o) $(B)/gcc/libtest.a $(gcc_libs)
	$(say) LD $@
	gcc -o $@ $^ -Wl,--as-needed -ljansson $(feature_libs) -lmpfr -lgmp -lm

# What is only counted runs side by side; what is timed, alone.
levine_counted := $(foreach p,trials sphere dimensions hull retrieval sweep,$(B)/bench/levine/$(p).txt)
$(B)/bench/levine/%.txt: $(B)/bench-levine FORCE
	@mkdir -p $(@D)
	$(say) RUN $@
	$< $* > $@

.PHONY: bench-levine
bench-levine: ## Run the tables of Levine 1975 again and write docs/levine.md with its pictures
	@.ci/need levine
	@$(MAKE) --no-print-directory $(levine_counted)
	@$(MAKE) --no-print-directory $(B)/bench/levine/hidden.txt
	@$(MAKE) --no-print-directory $(B)/bench/levine/large.txt
	@sh tests/bench/levine/write.sh $(B)/bench/levine docs
	@grep -E '^\| (App|ch|fig)' docs/levine.md
