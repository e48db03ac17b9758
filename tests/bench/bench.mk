# Benchmarks: never part of `make check`, for machines are noisy.
bench_o := $(patsubst tests/bench/%,$(B)/gcc/tests/bench/%.o,$(basename $(wildcard tests/bench/*.c tests/bench/*.cpp)))
$(B)/gcc/tests/bench/peers.o: tests/bench/peers.cpp
	@mkdir -p $(@D)
	$(say) CXX $@
	g++ -std=c++17 -O2 -DNDEBUG -Wall -Wextra -Werror -Ifirmware -Ihal/include -Itests -MMD -MP -c $< -o $@
-include $(bench_o:.o=.d)

$(B)/bench-cone: $(bench_o) $(B)/gcc/libfirmware.a
	$(say) LD $@
	g++ -o $@ $^ -lmpfr -lgmp -lm

.PHONY: bench-cone
bench-cone: ## Measure the narrowest cone and the hull beside a bare pass and other programs
	@.ci/need bench
	@$(MAKE) --no-print-directory $(B)/bench-cone
	@sh tests/bench/cone.sh $(B)/bench-cone $(B)/bench

.PHONY: bench-scene
bench-scene: $(B)/gcc/tests/property/scene_aim ## Measure how many of a million points aiming at a scene reads
	LARGE=1000000 $<

-include $(B)/gcc/tests/bench/regular/growth.d
.PHONY: bench-regular
bench-regular: $(B)/gcc/tests/bench/regular/growth ## Count how the cost of regular projections grows, and time their reach
	$<
