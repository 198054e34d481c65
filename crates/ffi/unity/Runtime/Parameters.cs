using System;

namespace Incise
{
    public sealed partial class Scene
    {
        /// <summary>Sets a parameter by name, see <see cref="SceneParameter"/>.</summary>
        /// <remarks>A number, true, false, a name, numbers between commas, or none.</remarks>
        public void Set(string name, string value)
        {
            Native.Check(Native.incise_scene_set(handle, Native.Utf8(name), Native.Utf8(value)));
        }

        /// <summary>Sets a parameter that is a number; 1 and 0 are true and false.</summary>
        public void Set(string name, double value)
        {
            Native.Check(Native.incise_scene_set_number(handle, Native.Utf8(name), value));
        }

        /// <summary>Returns a parameter as a text.</summary>
        public string GetText(string name)
        {
            return Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                Native.incise_scene_get(
                    handle, Native.Utf8(name), bytes, capacity, out length));
        }

        /// <summary>Returns a parameter that is a number; 1 and 0 are true and false.</summary>
        public double GetNumber(string name)
        {
            double value;
            Native.Check(Native.incise_scene_get_number(handle, Native.Utf8(name), out value));
            return value;
        }

        /// <summary>Sets a parameter of a body, see <see cref="MaterialParameter"/>.</summary>
        public void SetBody(uint body, string name, string value)
        {
            Native.Check(Native.incise_body_set(
                handle, body, Native.Utf8(name), Native.Utf8(value)));
        }

        /// <summary>Sets a parameter of a body that is a number.</summary>
        public void SetBody(uint body, string name, double value)
        {
            Native.Check(Native.incise_body_set_number(handle, body, Native.Utf8(name), value));
        }

        /// <summary>Returns a parameter of a body as a text.</summary>
        public string GetBodyText(uint body, string name)
        {
            return Native.GetText((byte[] bytes, UIntPtr capacity, out UIntPtr length) =>
                Native.incise_body_get(
                    handle, body, Native.Utf8(name), bytes, capacity, out length));
        }

        /// <summary>Returns a parameter of a body that is a number.</summary>
        public double GetBodyNumber(uint body, string name)
        {
            double value;
            Native.Check(Native.incise_body_get_number(
                handle, body, Native.Utf8(name), out value));
            return value;
        }
    }
}
