"""The compiler as a whole: the stages in order, checks of all scenes, and the cache of compiled models."""
