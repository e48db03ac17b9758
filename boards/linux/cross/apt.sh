# Sourced: the distribution's packages for another processor, from the sources that this machine's apt has. Nothing is
# installed, and the architectures that dpkg knows stay as they are: the other's lists have a folder of their own.
# Architectures are named as dpkg does: arm64, armhf; this machine's own works, too, with its own lists.
cross_cache=${BORESIGHT_CROSS_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/boresight-cross}

# With apt_release=NAME (trixie) the packages of that release of Debian instead, from where this machine's own Debian packages come.
apt_for() { # ARCHITECTURE apt-get|apt-cache ARGUMENT...
    apt_state=$cross_cache/apt-${apt_release:+$apt_release-}$1
    apt_architecture=$1 apt_program=$2
    shift 2
    if [ "$apt_architecture" = "$(dpkg --print-architecture)" ] && [ -z "${apt_release:-}" ]; then
        $apt_program "$@"
        return
    fi
    mkdir -p "$apt_state/lists/partial" "$apt_state/cache/archives/partial"
    : >>"$apt_state/status"
    [ -z "${apt_release:-}" ] || set -- -o "Dir::Etc::SourceList=$apt_state/sources.list" -o Dir::Etc::SourceParts=- "$@"
    $apt_program -o "APT::Architecture=$apt_architecture" -o "APT::Architectures=$apt_architecture" -o "Dir::State=$apt_state" \
        -o "Dir::State::status=$apt_state/status" -o "Dir::Cache=$apt_state/cache" -o Acquire::Languages=none -o APT::Sandbox::User= "$@"
}

# A source that fails (it has nothing for that processor, it is just being renewed) need not matter: what is then missing is named.
apt_update() { # ARCHITECTURE
    if [ -n "${apt_release:-}" ]; then
        # shellcheck disable=SC2016
        apt_from=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null | awk '$1 == "Debian" { print $2; exit }')
        mkdir -p "$cross_cache/apt-$apt_release-$1"
        echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $apt_from $apt_release main" >"$cross_cache/apt-$apt_release-$1/sources.list"
    elif [ "$1" = "$(dpkg --print-architecture)" ]; then
        return 0
    fi
    apt_for "$1" apt-get update -q || true
}

apt_knows() { # ARCHITECTURE PACKAGE
    apt_for "$1" apt-cache show "$2" >/dev/null 2>&1
}

# Into the current folder. What an old list names may have gone from the servers: then with a new list, once.
apt_fetch() { # ARCHITECTURE PACKAGE...
    apt_architecture=$1
    shift
    apt_for "$apt_architecture" apt-get download -q "$@" || {
        apt_update "$apt_architecture"
        apt_for "$apt_architecture" apt-get download -q "$@"
    }
}
