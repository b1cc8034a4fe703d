"""What the tests of the package share."""
import rivulet


def refused(work, *words, kind=rivulet.BadInput):
    """work() raises `kind`, and its sentence holds all `words`."""
    try:
        work()
    except kind as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError(f"not refused: {words}")
