#!/usr/bin/python3
"""Opens OUT/film.webp with Pillow and looks whether the powder moves as it must.

    tests/browser/check_film.py OUT

Exit code 0 when it is an animated picture of a few MB whose pictures differ, in which the powder first rises, then goes along x,
and both powders are to be seen. Needs python3-pil.
"""
import os
import sys

from PIL import Image


def powder(picture):
    """Pixels of powder A (blue) and B (orange), and their mean place [px] along x and down."""
    small = picture.convert("RGB").resize((picture.width // 2, picture.height // 2), Image.NEAREST)
    count, along, down = [0, 0], 0, 0
    for at, (red, _, blue) in enumerate(small.getdata()):
        if abs(blue - red) > 70:
            count[red > blue] += 1
            along += at % small.width
            down += at // small.width
    assert min(count) > 100, f"{count} pixels of A and B"
    return count, 2 * along / sum(count), 2 * down / sum(count)


def main(out):
    path = os.path.join(out, "film.webp")
    assert os.path.getsize(path) < 4 << 20, f"{os.path.getsize(path)} bytes"
    film = Image.open(path)
    film.load()
    assert film.format == "WEBP" and film.is_animated, film
    pictures, times = [], []
    for k in range(film.n_frames):
        film.seek(k)
        film.load()
        times.append(film.info["duration"])
        pictures.append(film.convert("RGB"))
    # filled, drawn out, ten of the rise, 62 instants, the layer
    assert len(pictures) == 1 + 1 + 10 + 62 + 1, f"{len(pictures)} pictures"
    assert 3000 < sum(times) < 15000 and min(times) > 20, times
    same = [k for k in range(1, len(pictures)) if pictures[k].tobytes() == pictures[k - 1].tobytes()]
    assert not same, f"pictures that are the same as the one before: {same}"
    _, filled_x, filled_y = powder(pictures[0])
    _, risen_x, risen_y = powder(pictures[11])
    assert risen_y < filled_y - 1, f"the bed does not rise: {filled_y} to {risen_y} px"
    assert abs(risen_x - filled_x) < 0.01 * film.width, f"the bed moves along x while it rises: {filled_x} to {risen_x} px"
    # until the heap goes over the end
    sweep = [powder(pictures[k])[1] for k in range(12, 54, 6)]
    assert all(b > a - 2 for a, b in zip(sweep, sweep[1:])), f"the powder goes back: {sweep}"
    assert powder(pictures[-1])[1] > risen_x + 0.15 * film.width, "nothing is laid"
    print(f"film.webp: {film.width} x {film.height}, {len(pictures)} pictures, {sum(times) / 1e3:.1f} s, {os.path.getsize(path)} bytes")


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except AssertionError as error:
        sys.exit(f"check_film: {error}")
